// tools/develop/denoise/row_loops.h: what is done with a row of pixels for each neighbour, as vectors. The same bits on all
// processors. docs/developing.md, "Denoising".
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace latent::develop {

// `to` = the sum of `count` rows, `step` numbers apart.
void add_up(std::size_t n, std::size_t count, const float* rows, std::size_t step, float* to);

// Rows of pixels and of their neighbours.
struct Pair {
    const float *a = nullptr, *b = nullptr;
};
struct ComparedLight {
    Pair value, variance;
};
// `to` = the mean over `channels` of (a - b)^2 / (v + w), where a and b have the variances v and w.
void compare_light(std::size_t n, std::span<const ComparedLight> channels, float* to);

struct ComparedVectors {
    std::array<Pair, 3> of{};
    float scale = 0;  // factor of squared distances: weights fall to 0 at 1
};
struct ComparedPixels {
    const float* light = nullptr;    // compared, added up over a patch
    const float* columns = nullptr;  // the patch's
    float rows = 0;
    std::span<const ComparedVectors> vectors{};
    Pair depth{};  // null: not known
    float depth_scale = 0;
    Pair known{};  // 1, or 0 where nothing is known; null: all are
};
// What neighbours count.
void weigh(std::size_t n, const ComparedPixels& compared, float* weights);

// `sums` += `row`; weights x values; weights^2 x values.
void add_row(std::size_t n, const float* row, float* sums);
void add_products(std::size_t n, const float* weights, const float* values, float* sums);
void add_squared_products(std::size_t n, const float* weights, const float* values, float* sums);

}  // namespace latent::develop
