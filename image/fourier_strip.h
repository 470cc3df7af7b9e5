// image/fourier_strip.h: the inner loop of SquareFourier, one source for every vector width. Only image/fourier.cpp calls it.
#pragma once

#include <cstddef>

namespace latent::image {

inline constexpr std::size_t kStripLanes = 16;

// kStripLanes transforms of `size` numbers side by side: number i of transform k is at i * kStripLanes + k. `cosine` and `sine` are
// of 2 pi k / size, k < size.
void fourier_strip(bool forward, float* re, float* im, std::size_t size, const float* cosine, const float* sine);

}  // namespace latent::image
