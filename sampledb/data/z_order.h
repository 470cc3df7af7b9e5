// sampledb/data/z_order.h: the Z-order curve over the film: one number whose prefixes are quadtree nodes.
#pragma once

#include <cstdint>

namespace latent::sampledb {

inline constexpr int kZPrefixLevels = 16;  // levels of the quadtree that a 32-bit Z prefix tells apart

// The 16 low bits of x and y, interleaved; y's bit above x's, so that children are numbered row by row.
constexpr std::uint32_t interleave(std::uint32_t x, std::uint32_t y) {
    std::uint64_t both = std::uint64_t{y & 0xFFFF} << 32 | (x & 0xFFFF);  // spread at once, in one half each
    both = (both | both << 8) & 0x00FF00FF00FF00FF;
    both = (both | both << 4) & 0x0F0F0F0F0F0F0F0F;
    both = (both | both << 2) & 0x3333333333333333;
    both = (both | both << 1) & 0x5555555555555555;
    return static_cast<std::uint32_t>(both >> 31 | both);
}

// The 16 high bits of both coordinates of a position on the film, interleaved.
constexpr std::uint32_t z_prefix(std::uint32_t u, std::uint32_t v) { return interleave(u >> 16, v >> 16); }

// The place of a cell along the curve.
constexpr std::uint64_t z_code(std::uint32_t x, std::uint32_t y) {
    return std::uint64_t{interleave(x >> 16, y >> 16)} << 32 | interleave(x, y);
}

}  // namespace latent::sampledb
