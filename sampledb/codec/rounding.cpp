#include "sampledb/codec/rounding.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <span>

#include "base/hash.h"

namespace latent::sampledb {

namespace {

constexpr std::size_t kBlock = 512;                // records whose seeds are made at once
constexpr std::uint32_t kIndexStep = 0x9E3779B9u;  // 2^32 / golden ratio, odd

// The finalizer of SplitMix64 [SplitMix64].
constexpr std::uint64_t mix64(std::uint64_t x) {
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
    x = (x ^ x >> 27) * 0x94D049BB133111EBu;
    return x ^ x >> 31;
}
// Its like for 32 bits [Wellons18]: lowbias32.
constexpr std::uint32_t mix32(std::uint32_t x) {
    x = (x ^ x >> 16) * 0x7FEB352Du;
    x = (x ^ x >> 15) * 0x846CA68Bu;
    return x ^ x >> 16;
}

// Value i gets the random number of `low[i]` and `high[i]`, the halves of its record's seed.
void round_column(std::span<float> values, std::uint32_t index, unsigned dropped, const std::uint32_t* low,
                  const std::uint32_t* high) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::uint32_t random = mix32(low[i] + index * kIndexStep) ^ high[i];
        values[i] = std::bit_cast<float>(rounded(std::bit_cast<std::uint32_t>(values[i]), dropped, random));
    }
}

void round_pairs(float* power, std::uint32_t pairs, unsigned dropped, std::uint64_t seed) {
    for (std::uint32_t i = 0; i < pairs; ++i)
        power[i] = std::bit_cast<float>(rounded(std::bit_cast<std::uint32_t>(power[i]), dropped, rounding_random(seed, i)));
}

}  // namespace

std::uint64_t rounding_key(const JobId& job) {
    std::array<std::byte, 16> bytes;
    store_le(&bytes[0], job.low);
    store_le(&bytes[8], job.high);
    return hash64(bytes);
}

std::uint64_t rounding_seed(std::uint64_t key, std::uint64_t sample, std::uint32_t u, std::uint32_t v) {
    return mix64(key + sample * 0x9E3779B97F4A7C15u + (std::uint64_t{v} << 32 | u) * 0xD1B54A32D192ED03u);
}

std::uint32_t rounding_random(std::uint64_t seed, std::uint32_t index) {
    return mix32(static_cast<std::uint32_t>(seed) + index * kIndexStep) ^ static_cast<std::uint32_t>(seed >> 32);
}

void round_values(const Job& job, Page& page) {
    if (job.precision >= kFullPrecision) return;
    const unsigned dropped = kFullPrecision - job.precision;
    const std::uint64_t key = rounding_key(job.id);
    const auto seed_of = [&](std::size_t row) { return rounding_seed(key, page.sample[row], page.u[row], page.v[row]); };
    if (job.kind == RecordKind::kSpectral) {
        float* power = page.power.data();
        for (std::size_t row = 0; row < page.count; power += page.pairs[row], ++row)
            round_pairs(power, page.pairs[row], dropped, seed_of(row));
        return;
    }
    std::array<std::uint32_t, kBlock> low, high;
    for (std::size_t first = 0; first < page.count; first += kBlock) {
        const std::size_t n = std::min(kBlock, page.count - first);
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint64_t seed = seed_of(first + i);
            low[i] = static_cast<std::uint32_t>(seed);
            high[i] = static_cast<std::uint32_t>(seed >> 32);
        }
        std::uint32_t index = 0;
        for (std::vector<float>* const column : {&page.x, &page.y, &page.z})
            round_column(std::span(*column).subspan(first, n), index++, dropped, low.data(), high.data());
    }
}

}  // namespace latent::sampledb
