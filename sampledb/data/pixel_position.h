// sampledb/data/pixel_position.h: where in its pixel a sample lies, step by step: for one, and in loops that become vectors.
// docs/format.md, "Samplers".
#pragma once

#include <algorithm>
#include <cstdint>

#include "base/mix.h"
#include "sampledb/data/film_position.h"

namespace latent::sampledb {

// Pascal's matrix mod 2: bit j is the sum of all bits i of x whose binary digits include those of j.
inline std::uint32_t pascal(std::uint32_t x) {
    x ^= x >> 1 & 0x55555555;
    x ^= x >> 2 & 0x33333333;
    x ^= x >> 4 & 0x0F0F0F0F;
    x ^= x >> 8 & 0x00FF00FF;
    return x ^ x >> 16;
}

inline std::uint64_t pixel_key(const PositionSamplerSpec& spec) { return std::uint64_t{spec.shift_v} << 32 | spec.shift_u; }

// A pixel's two shifts: that of u in the low half, that of v in the high one.
inline std::uint64_t pixel_shifts(std::uint64_t key, std::uint32_t x, std::uint32_t y) {
    return mix(key + (std::uint64_t{y} << 32 | x) * 0x9E3779B97F4A7C15u);
}

// floor((pixel 2^32 + offset) / side), with an offset of at least side - 1 so that it lies in the pixel. Doubles are exact: as side
// is at most 2^21, no quotient comes within half a unit in the last place of a whole number that it is below.
inline std::uint32_t film_coordinate(std::uint32_t pixel, std::uint32_t offset, std::uint32_t side) {
    constexpr std::uint32_t kHalf = 1u << 31;  // vectors convert signed integers only
    const auto within = static_cast<std::int32_t>(std::max(offset, side - 1) - kHalf);
    const double at = static_cast<std::int32_t>(pixel) * 0x1p32 + (within + 0x1p31);
    const double quotient = at / static_cast<std::int32_t>(side);
    const auto half = static_cast<std::int32_t>(quotient * 0.5);
    return 2 * static_cast<std::uint32_t>(half) + (quotient - half * 2.0 >= 1 ? 1 : 0);
}

}  // namespace latent::sampledb
