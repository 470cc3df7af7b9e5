// tools/develop/channels/normalise.h: sums of a row of pixels become their values. docs/developing.md, "Definitions".
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "tools/develop/channels/layers.h"

namespace latent::develop {

// Sums of one pixel after another, layout.stride() each: sums of w s per channel, then (camera) of w c, ... Null: there are none.
struct SumRow {
    const double* camera;
    const double* light;
    const RowLayout& layout;
    std::span<const double> min_weight;  // each pixel's
    std::span<const double> light_scale;
    std::array<double, 2> half_scale{};  // factors for the light images of the halves, on top of light_scale
};

// Writes layout.outputs() floats per pixel: first camera sums / sum w c, plus light sums times their scale. Where sum w c is below
// its least or 0, only the light counts; returns how many such pixels there are. A half needs half of that least.
std::size_t normalise_row(const SumRow& row, float* out);

}  // namespace latent::develop
