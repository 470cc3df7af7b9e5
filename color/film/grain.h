// color/film/grain.h: grain as a function of the place on the negative: the same in every crop and at every size. Equations:
// docs/color.md, "Grain".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "color/film/material.h"
#include "color/film/process_row.h"

namespace latent::film {

// How strong it is: standard deviation of density through an aperture of 48 um, by the density above the base of each layer.
// `pushed`: stops of longer development. Errors: of the tables; kUnsupported if nothing is known of the film's granularity.
Result<std::array<Table1, 3>> granularity(const Material& film, double pushed);

// Noise of unit strength at 48 um. White up to dye clouds of 12 um across, whose density is a tent:
//   power(f) ~ sinc^4(6 um f) along each axis.
class GrainField {
 public:
    // Pixels of this size on the film. `layers`: 1 (black and white) or 3.
    GrainField(std::uint64_t seed, double pixel_um, int layers);

    // Buffers of one thread, kept from call to call.
    struct Scratch {
        std::vector<float> coarse, fine, sums;
    };
    // Means over the pixels x0 .. x0 + width - 1, y0 .. y0 + height - 1 (from the corner of the frame, 0 or more), into planes of
    // that size.
    void fill(int x0, int y0, int width, int height, const std::array<float*, 3>& planes, Scratch& scratch) const;
    int layers() const { return layers_; }
    // Bytes of scratch that a block of this size takes.
    std::size_t scratch_bytes(int width, int height) const;

 private:
    // Cells that a pixel sees along an axis, and how much of each.
    struct Span1 {
        std::int64_t first = 0;
        std::vector<float> weights;
    };
    Span1 seen_by(std::int64_t pixel) const;
    void cells(std::uint64_t layer, std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1, Scratch& scratch) const;

    std::uint64_t seed_;
    double pixel_um_, cell_um_ = 0;
    int layers_, level_ = 0;  // cells of level n are kCoarsest / 2^n wide
    double strength_ = 1;     // of a mean over a pixel, along one axis
};

}  // namespace latent::film
