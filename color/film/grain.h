// color/film/grain.h: grain as a function of the place on the negative: the same in every crop and at every size. Equations:
// docs/color.md, "Grain".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "color/film/material.h"
#include "color/film/process_tables.h"

namespace latent::film {

// How strong it is: standard deviation of the amount of dye (black and white: of density) through an aperture of 48 um, by that
// amount in each layer. Densitometers then read what the data sheet says. `pushed`: stops of longer development. Errors: of the
// tables; kUnsupported if nothing is known of the film's granularity.
Result<std::array<Table1, 3>> granularity(const Material& film, double pushed);

// Noise of unit strength at 48 um. White up to dye clouds of 12 um across, whose density is a tent:
//   power(f) ~ sinc^4(6 um f) along each axis.
class GrainField {
 public:
    // Pixels of this size on the film. `layers`: 1 (black and white) or 3.
    GrainField(std::uint64_t seed, double pixel_um, int layers);

    // Cells that pixels see along an axis, and how much of each: `each` weights a pixel.
    struct Taps {
        int begin = 0, pixels = 0, each = 0;
        std::vector<std::int64_t> first;  // cell, by pixel
        std::vector<float> weights;
    };
    // Buffers of one thread, kept from call to call.
    struct Scratch {
        std::vector<float> coarse, fine, sums;
        Taps columns, rows;
    };
    // Means over the pixels x0 .. x0 + width - 1, y0 .. y0 + height - 1 (from the corner of the frame, 0 or more), into planes of
    // that size.
    void fill(int x0, int y0, int width, int height, const std::array<float*, 3>& planes, Scratch& scratch) const;
    // Bytes of scratch that a block of this size takes.
    std::size_t scratch_bytes(int width, int height) const;

 private:
    struct Cells {
        std::int64_t x0, y0, x1, y1;  // inclusive
        std::size_t width() const { return static_cast<std::size_t>(x1 - x0 + 1); }
        std::size_t height() const { return static_cast<std::size_t>(y1 - y0 + 1); }
    };
    void see(int begin, int pixels, Taps& taps) const;
    Cells fill_cells(std::uint64_t layer, const Cells& wanted, Scratch& scratch) const;

    std::uint64_t seed_;
    double pixel_um_, cell_um_ = 0;
    int layers_, level_ = 0;  // cells of level n are kCoarsest / 2^n wide
    double strength_ = 1;     // standard deviation of a mean over a pixel, along one axis
};

}  // namespace latent::film
