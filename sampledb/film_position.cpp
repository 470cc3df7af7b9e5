#include "sampledb/film_position.h"

#include <array>
#include <cassert>

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
constexpr std::uint32_t kFractionError = 2 * kPow8;  // of a sum of the first eight digits, the second eight and the rest: less
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

}  // namespace

void halton23(std::span<const std::uint64_t> n, const PositionSamplerSpec& spec, std::span<std::uint32_t> u,
              std::span<std::uint32_t> v) {
    assert(u.size() == n.size() && v.size() == n.size());
    for (std::size_t i = 0; i < n.size(); ++i) u[i] = reverse_bits(static_cast<std::uint32_t>(n[i])) + spec.shift_u;

    std::uint64_t high = 0, high_digits = 0, high_fraction = 0;  // neighbours in a run share their high digits
    for (std::size_t i = 0; i < n.size(); ++i) {
        const std::uint64_t q = n[i] / kPow16;
        const auto low = static_cast<std::uint32_t>(n[i] - q * kPow16);
        if (q != high) {
            high = q;
            high_digits = reversed_high_digits(q);
            high_fraction = static_cast<std::uint64_t>((U128{high_digits} << 64) / kPow40);
        }
        const std::uint64_t first = kReversed[low % kPow8], second = kReversed[low / kPow8];
        // Each term is rounded down, so the sum is too small by less than kFractionError: which matters just below a multiple of
        // 2^-32 only.
        const std::uint64_t sum = first * kFraction8 + second * kFraction16 + high_fraction;
        v[i] = static_cast<std::uint32_t>(sum >> 32) + spec.shift_v;
        if (static_cast<std::uint32_t>(sum) > ~kFractionError)
            v[i] = fraction_of_digits(first * kPow32 + second * kPow24 + high_digits) + spec.shift_v;
    }
}

FilmPosition halton23(std::uint64_t n, const PositionSamplerSpec& spec) {
    FilmPosition p;
    halton23({&n, 1}, spec, {&p.u, 1}, {&p.v, 1});
    return p;
}

}  // namespace latent::sampledb
