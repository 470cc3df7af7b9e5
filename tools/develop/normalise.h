// tools/develop/normalise.h: sums of a row of pixels become their values. docs/developing.md, "Definitions".
#pragma once

#include <cstddef>
#include <span>

namespace latent::develop {

// Sums of one pixel after another, `stride` each: sums of w s per channel, then (camera) of w c. Null: there are none.
struct SumRow {
    const double* camera;
    const double* light;
    int stride;
    std::span<const double> least_weight;  // of each pixel
    std::span<const double> light_scale;
};

// Writes `channels` floats per pixel: camera sums / sum w c, plus light sums times their scale. Where sum w c is below its least or
// 0, only the light counts; returns how many such pixels there are.
std::size_t normalise_row(const SumRow& row, int channels, float* out);

}  // namespace latent::develop
