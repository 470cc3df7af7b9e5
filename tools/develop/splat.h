// tools/develop/splat.h: the inner loop of developing: spreads records over the pixels of a cell's window. Same bits on all
// processors.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "tools/develop/filter.h"

namespace latent::develop {

// Records that a batch holds, as columns; a segment is a range of rows that lie in one cell.
struct RecordColumns {
    const std::uint32_t* x;  // FilmGrid::place_x, place_y
    const std::uint32_t* y;
    const float* values;  // `lanes` per record: channel values, then the share (light records: 0), then zeros
};
struct Segment {
    std::uint64_t page;  // page_order (batch.h)
    std::uint32_t first, count;
};

// Sums of one pixel, in float64: `lanes` sums of w s (the last ones of w c), and, if the filter has negative lobes, `lanes` more:
// non-negative weights add to the former, negative ones to the latter. So the signed and the non-negative filter come from one
// pass.
struct PixelSums {
    int lanes = 4;       // a multiple of 4
    bool split = false;  // negative weights apart
    int doubles() const { return split ? 2 * lanes : lanes; }
};

// Adds the records of `segments`, in order, to a window of `row_pixels` pixels per row. `unit_sum` scales the weights of each
// record to sum to one over the pixel lattice (light records).
void splat(const FilterKernel& filter, const PixelSums& layout, bool unit_sum, const RecordColumns& records,
           std::span<const Segment> segments, double* window, std::size_t row_pixels);

// Pins the instructions that `splat` uses: "best", or one of `simd_levels()`. Errors: kUsage, listing them.
Status set_simd_level(std::string_view level);
std::vector<std::string_view>
simd_levels();  // those of base/simd.h that `splat` is compiled for and this processor has, slowest first

}  // namespace latent::develop
