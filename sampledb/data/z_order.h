// sampledb/data/z_order.h: the Z-order curve over the film: one number whose prefixes are quadtree nodes.
#pragma once

#include <cstdint>

namespace latent::sampledb {

inline constexpr int kZPrefixLevels = 16;  // levels of the quadtree that a 32-bit Z prefix tells apart

// The 16 high bits of u and v, interleaved; v's bit above u's, so that children are numbered row by row.
constexpr std::uint32_t z_prefix(std::uint32_t u, std::uint32_t v) {
    std::uint64_t x = std::uint64_t{v & 0xFFFF0000} << 16 | u >> 16;  // both are spread at once, in one half each
    x = (x | x << 8) & 0x00FF00FF00FF00FF;
    x = (x | x << 4) & 0x0F0F0F0F0F0F0F0F;
    x = (x | x << 2) & 0x3333333333333333;
    x = (x | x << 1) & 0x5555555555555555;
    return static_cast<std::uint32_t>(x >> 31 | x);
}

}  // namespace latent::sampledb
