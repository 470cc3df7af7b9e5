// sampledb/z_order.h: the Z-order curve over the film: one number whose prefixes are quadtree nodes.
#pragma once

#include <cstdint>

#include "sampledb/page.h"

namespace latent::sampledb {

inline constexpr int kZPrefixLevels = 16;  // levels of the quadtree that a 32-bit Z prefix tells apart

// Bit i of the result's even bits is bit i of `x`.
constexpr std::uint32_t spread_bits(std::uint32_t x) {
    x &= 0xFFFF;
    x = (x | x << 8) & 0x00FF00FF;
    x = (x | x << 4) & 0x0F0F0F0F;
    x = (x | x << 2) & 0x33333333;
    return (x | x << 1) & 0x55555555;
}

// The 16 high bits of u and v, interleaved; v's bit above u's, so that children are numbered row by row.
constexpr std::uint32_t z_prefix(std::uint32_t u, std::uint32_t v) { return spread_bits(v >> 16) << 1 | spread_bits(u >> 16); }

// First Z prefix inside a node (its level at most kZPrefixLevels).
constexpr std::uint32_t first_z(const FilmNode& node) {
    if (node.level == 0) return 0;
    const int shift = 32 - node.level;
    return z_prefix(node.x << shift, node.y << shift);
}

}  // namespace latent::sampledb
