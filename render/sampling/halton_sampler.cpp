#include "render/sampling/halton_sampler.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace latent::render {
namespace {

constexpr std::array<std::uint32_t, HaltonSampler::kPrimes> kBases = {5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61};
constexpr std::uint64_t kOne = std::uint64_t{1} << 60;

// A permutation of 0..base-1 that is a function of `key` (Fisher-Yates).
std::vector<std::uint32_t> permutation(std::uint32_t base, std::uint64_t key) {
    std::vector<std::uint32_t> p(base);
    std::iota(p.begin(), p.end(), 0u);
    for (std::uint32_t i = base - 1; i > 0; --i) {
        key = mix(key + 0x9e3779b97f4a7c15u);
        std::swap(p[i], p[static_cast<std::uint32_t>((key >> 32) * (i + 1) >> 32)]);
    }
    return p;
}

// Mirrors `digits` base-b digits of every number below b^digits about the point that follows `done` digits. The permutation of a
// digit depends on the digits before it in the block (nested scrambling [Owen95]), blocks are scrambled independently.
std::vector<std::uint64_t> scrambled_block(std::uint32_t base, std::uint32_t digits, std::uint64_t unit, std::uint64_t key) {
    std::vector<std::uint64_t> value{0};
    for (std::uint32_t d = 0; d < digits; ++d) {
        unit /= base;
        std::vector<std::uint64_t> longer(value.size() * base);
        for (std::size_t prefix = 0; prefix < value.size(); ++prefix) {
            const std::vector<std::uint32_t> p = permutation(base, mix(key + (d << 16) + prefix));
            for (std::uint32_t digit = 0; digit < base; ++digit)
                longer[prefix + digit * value.size()] = value[prefix] + p[digit] * unit;
        }
        value = std::move(longer);
    }
    return value;
}

std::uint64_t high_half(std::uint64_t a, std::uint64_t b) {
    return static_cast<std::uint64_t>(static_cast<unsigned __int128>(a) * b >> 64);
}

// x % divisor without a division; x below 2^60, `reciprocal` 2^64 / divisor rounded down: the quotient is at most one too small.
std::uint64_t remainder(std::uint64_t x, std::uint64_t divisor, std::uint64_t reciprocal) {
    const std::uint64_t rest = x - high_half(x, reciprocal) * divisor;
    return rest < divisor ? rest : rest - divisor;
}

}  // namespace

HaltonSampler::HaltonSampler(const sampledb::PositionSamplerSpec& positions, std::uint64_t seed,
                             const std::vector<std::uint32_t>& important, const std::vector<Sharing>& sharing)
    : Sampler(seed), positions_(positions) {
    std::map<std::uint32_t, std::uint32_t> base;
    for (std::size_t i = 0; i < std::min(important.size(), kPrimes); ++i) {
        base[important[i]] = kBases[i];
        add_radical(important[i], kBases[i], seed_ + (std::uint64_t{kBases[i]} << 40));
    }
    for (const auto& [dimension, with] : sharing) {
        if (base.count(with) == 0) continue;
        add_radical(dimension, base[with], seed_ + (std::uint64_t{base[with]} << 40) + (std::uint64_t{dimension + 1} << 32));
    }
}

void HaltonSampler::add_radical(std::uint32_t dimension, std::uint32_t base, std::uint64_t key) {
    Radical r;
    r.base = base;
    std::uint32_t digits = 0;
    for (r.block = 1; r.block * base <= 4096; r.block *= base) ++digits;
    r.reciprocal = ~std::uint64_t{0} / r.block + 1;
    std::uint64_t unit = kOne;
    while (unit > kOne >> 34) {
        r.table.push_back(scrambled_block(base, digits, unit, mix(key + r.table.size())));
        for (std::uint32_t d = 0; d < digits; ++d) unit /= base;
    }
    r.tail = unit;
    r.tail_reciprocal = ~std::uint64_t{0} / unit;
    set_spread(dimension, radicals_.size());
    radicals_.push_back(std::move(r));
}

Uniform HaltonSampler::spread(std::uint32_t as, const Key& key, std::uint64_t random) const {
    const Radical& r = radicals_[as];
    constexpr std::uint64_t kExact = std::uint64_t{1} << 52;
    std::uint64_t rest = key.n < kExact ? key.n : random % kExact;  // nobody renders so many
    std::uint64_t sum = 0;
    for (const std::vector<std::uint64_t>& table : r.table) {
        const std::uint64_t quotient = high_half(rest, r.reciprocal);
        sum += table[rest - quotient * r.block];
        rest = quotient;
    }
    return {(sum + remainder(random >> 4, r.tail, r.tail_reciprocal)) << 4};  // below 1, as every unit was rounded down
}

}  // namespace latent::render
