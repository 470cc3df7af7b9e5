// image/plausible_size.h: files that say they hold a picture much larger than they are.
#pragma once

#include <cstdint>

namespace latent::image {

// Readers make room for a picture before they read it. No useful file packs a large picture more tightly than this (deflate's best
// is 1032 bytes in one).
constexpr std::uint64_t kAlwaysPlausiblePixels = std::uint64_t{1} << 24;
constexpr std::uint64_t kMaxPixelsPerByte = 1024;

constexpr bool is_plausible_size(std::uint64_t width, std::uint64_t height, std::uint64_t file_bytes) {
    if (height == 0 || width <= kAlwaysPlausiblePixels / height) return true;
    return width <= (UINT64_MAX / height) && width * height / kMaxPixelsPerByte <= file_bytes;
}

}  // namespace latent::image
