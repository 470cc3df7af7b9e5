// tools/develop/denoise/row_loops.h: what is done with a row of pixels for each neighbour, as vectors. The same bits on all
// processors. docs/developing.md, "Denoising".
#pragma once

#include <array>
#include <cstddef>

namespace latent::develop {

// `to` += `from`, of n numbers.
void add_row(std::size_t n, const float* from, float* to);

// `to` *= `by`.
void multiply_row(std::size_t n, const float* by, float* to);

// `to` += share x (a - b)^2 / (v + w), where a and b have the variances v and w, but no more than a pixel can show.
void add_differences(std::size_t n, float share, const float* a, const float* b, const float* v, const float* w, float* to);

// Means of squared differences become weights.
void weigh_differences(std::size_t n, float* weights);

using Vectors = std::array<const float*, 3>;
// Weights fall with the squared distance of vectors, to 0 at 1 / scale.
void weigh_vectors(std::size_t n, float scale, const Vectors& a, const Vectors& b, float* weights);
// The same, of the relative difference of depths.
void weigh_depths(std::size_t n, float scale, const float* a, const float* b, float* weights);

// `sums` += weights x values, or weights^2 x values.
void add_products(std::size_t n, const float* weights, const float* values, float* sums);
void add_squared_products(std::size_t n, const float* weights, const float* values, float* sums);

}  // namespace latent::develop
