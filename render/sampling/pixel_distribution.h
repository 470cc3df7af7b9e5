// render/sampling/pixel_distribution.h: the pixels of an image as a distribution.
#pragma once

#include "render/sampling/piecewise_constant.h"

namespace latent::render {

// Draws a pixel by its weight, and where in it; neighbours stay neighbours. Nothing that shines is never drawn, whatever its
// weight: a tenth goes anywhere.
class PixelDistribution {
 public:
    PixelDistribution() = default;
    // `weight`: not negative, rows of `width` pixels. `mean`: theirs.
    PixelDistribution(std::vector<double> weight, std::uint32_t width, double mean);

    struct Pixel {
        std::uint32_t x, y;
        Uniform in_x, in_y;  // where in it
    };
    Pixel sample(Uniform u, Uniform v) const;
    // Times the number of pixels: 1 where all have the same weight.
    double density(std::uint32_t x, std::uint32_t y) const {
        return rows_.probability(y) * columns_[y].probability(x) * static_cast<double>(columns_[y].size() * rows_.size());
    }

 private:
    PiecewiseConstant rows_;
    std::vector<PiecewiseConstant> columns_;  // one for the pixels of each row
};

}  // namespace latent::render
