#include "sampledb/data/film_position.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "sampledb/data/pixel_lattice.h"

namespace latent::sampledb {

namespace {

constexpr std::uint32_t kPow8 = 6561;                      // 3^8: digits are turned over eight at a time
constexpr std::uint64_t kPow16 = 43046721;                 // 3^16
constexpr std::uint64_t kPow24 = 282429536481;             // 3^24
constexpr std::uint64_t kPow32 = 1853020188851841;         // 3^32
constexpr std::uint64_t kPow40 = 12157665459056928801u;    // 3^40, below 2^64
constexpr std::uint64_t kInverse = 13994560389365007135u;  // ceil(2^127 / 3^40)

using U128 = unsigned __int128;
constexpr auto kFraction8 = static_cast<std::uint64_t>((U128{1} << 64) / kPow8);    // 3^-8 in units of 2^-64
constexpr auto kFraction16 = static_cast<std::uint64_t>((U128{1} << 64) / kPow16);  // 3^-16
constexpr std::uint32_t kFractionError =
    2 * kPow8;  // a sum of the first eight digits, the second eight and the rest is off by less
static_assert(U128{kInverse} * kPow40 >= U128{1} << 127 && U128{kInverse - 1} * kPow40 < U128{1} << 127);

// Eight ternary digits in reverse order.
constexpr auto kReversed = [] {
    std::array<std::uint16_t, kPow8> table{};
    for (std::uint32_t i = 0; i < kPow8; ++i) {
        std::uint32_t reversed = 0;
        for (std::uint32_t digit = 0, rest = i; digit < 8; ++digit, rest /= 3) reversed = reversed * 3 + rest % 3;
        table[i] = static_cast<std::uint16_t>(reversed);
    }
    return table;
}();

// Digits 16..39 of n = 3^16 q + ..., reversed, as the low part of a 40-digit number.
std::uint64_t reversed_high_digits(std::uint64_t q) {
    return kReversed[q % kPow8] * kPow16 + std::uint64_t{kReversed[q / kPow8 % kPow8]} * kPow8 + kReversed[q / kPow16 % kPow8];
}

// floor(reversed 2^32 / 3^40). The product with the rounded reciprocal is too large by less than 2^-31, so at most by one.
std::uint32_t fraction_of_digits(std::uint64_t reversed) {
    std::uint32_t v = static_cast<std::uint32_t>((U128{reversed} * kInverse) >> 95);
    if ((reversed << 32) - v * kPow40 >= kPow40) --v;
    return v;
}

// phi_3 of one number, exactly.
std::uint32_t phi3(std::uint64_t n) {
    const auto low = static_cast<std::uint32_t>(n % kPow16);
    return fraction_of_digits(kReversed[low % kPow8] * kPow32 + kReversed[low / kPow8] * kPow24 + reversed_high_digits(n / kPow16));
}

// phi_3 of many numbers that share their digits from the 16th on, as those of a run mostly do: what these add is divided once, and
// the other digits are found in loops that become vectors.
class Phi3 {
 public:
    static constexpr std::size_t kBlock = 256;

    // At most kBlock numbers.
    void operator()(std::span<const std::uint64_t> n, std::uint32_t shift, std::uint32_t* v) {
        const std::uint64_t q = n[0] / kPow16;
        std::array<std::uint32_t, kBlock> first, second;
        std::uint64_t shared = ~std::uint64_t{0};  // the sign bit: every low part is below 3^16
        for (std::size_t i = 0; i < n.size(); ++i) {
            const std::uint64_t low = n[i] - q * kPow16;
            shared &= (low - kPow16) & ~low;
            first[i] = static_cast<std::uint32_t>(low);
        }
        if (shared >> 63 == 0) {
            for (std::size_t i = 0; i < n.size(); ++i) v[i] = phi3(n[i]) + shift;
            return;
        }
        for (std::size_t i = 0; i < n.size(); ++i) {
            second[i] = first[i] / kPow8;
            first[i] %= kPow8;
        }
        if (q != q_) {
            q_ = q;
            fraction_ = static_cast<std::uint64_t>((U128{reversed_high_digits(q)} << 64) / kPow40);
        }
        for (std::size_t i = 0; i < n.size(); ++i) {
            // Each term is rounded down, so the sum is too small by less than kFractionError: which matters just below a multiple
            // of 2^-32 only.
            const std::uint64_t sum = kReversed[first[i]] * kFraction8 + kReversed[second[i]] * kFraction16 + fraction_;
            v[i] = static_cast<std::uint32_t>(sum >> 32) + shift;
            if (static_cast<std::uint32_t>(sum) > ~kFractionError) v[i] = phi3(n[i]) + shift;
        }
    }

 private:
    std::uint64_t q_ = 0, fraction_ = 0;
};

}  // namespace

void halton23(std::span<const std::uint64_t> n, const PositionSamplerSpec& spec, std::span<std::uint32_t> u,
              std::span<std::uint32_t> v) {
    assert(u.size() == n.size() && v.size() == n.size());
    for (std::size_t i = 0; i < n.size(); ++i) u[i] = reverse_bits(static_cast<std::uint32_t>(n[i])) + spec.shift_u;
    Phi3 phi;
    for (std::size_t i = 0; i < n.size(); i += Phi3::kBlock)
        phi(n.subspan(i, std::min(Phi3::kBlock, n.size() - i)), spec.shift_v, &v[i]);
}

FilmPosition halton23(std::uint64_t n, const PositionSamplerSpec& spec) {
    return {reverse_bits(static_cast<std::uint32_t>(n)) + spec.shift_u, phi3(n) + spec.shift_v};
}

FilmPosition position_of(std::uint64_t n, const PositionSamplerSpec& spec) {
    if (spec.sampler == PositionSampler::kHalton23) return halton23(n, spec);
    const PixelLattice lattice(spec);
    return lattice.position(lattice.place(n));
}

void positions_of(std::span<const std::uint64_t> n, const PositionSamplerSpec& spec, std::span<std::uint32_t> u,
                  std::span<std::uint32_t> v) {
    if (spec.sampler == PositionSampler::kHalton23) return halton23(n, spec, u, v);
    assert(u.size() == n.size() && v.size() == n.size());
    const PixelLattice lattice(spec);
    for (std::size_t i = 0; i < n.size(); ++i) {
        const FilmPosition at = lattice.position(lattice.place(n[i]));
        u[i] = at.u;
        v[i] = at.v;
    }
}

}  // namespace latent::sampledb
