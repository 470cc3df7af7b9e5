// tools/develop/kernel/splat.h: the inner loop of developing: spreads records over the pixels of a cell's window. Same bits on all
// processors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "tools/develop/channels/layers.h"
#include "tools/develop/film/film_grid.h"
#include "tools/develop/film/filter.h"

namespace latent::develop {

// Where the records of a segment lie: their x, their y, then their values. What is drawn together is near in memory, however few
// records a segment has.
struct SegmentColumns {
    std::uint32_t* x;  // FilmGrid::place_x, place_y
    std::uint32_t* y;
    float* values;  // `entries.stride()` per record (layers.h): channel values, then the share (light records: 0), ...

    static std::size_t bytes(std::size_t count, std::size_t stride) { return count * (2 + stride) * sizeof(float); }
    static SegmentColumns at(std::byte* memory, std::size_t count) {
        auto* const x = reinterpret_cast<std::uint32_t*>(memory);
        return {x, x + count, reinterpret_cast<float*>(x + 2 * count)};
    }
};
// Records of one page that lie in one cell. So many bytes behind the last value can be read.
struct Segment {
    static constexpr std::size_t kReadable = 64;
    std::uint64_t page;  // page_order (record_batch.h)
    std::byte* memory;
    std::uint32_t count;
    std::uint32_t room = count;  // records that the columns have room for

    SegmentColumns columns() const { return SegmentColumns::at(memory, room); }
};

enum class Weights : std::uint8_t {
    kSigned,    // the filter
    kPositive,  // its non-negative part
    kUnitSum,   // the filter, scaled so that the weights of a record sum to one over the pixel lattice (light records)
};

// Adds the records of `segments`, in order, to a window of `row_pixels` pixels per row. A pixel has a sum in float64 for each
// entry: of w s, w^2 s or s; or what was chosen (layers.h).
void splat(const FilterKernel& filter, const EntryCounts& entries, Weights weights, std::span<const Segment> segments,
           double* window, std::size_t row_pixels);

// The same, of the records alone that reach one of `pixels` (of the window; at most 256 in a row). `patch`: rows of
// patch_of(filter, pixels).width() pixels; those of `pixels` begin at its pixel (side - 1, side - 1) and get all that the records
// give them.
void splat_patch(const FilterKernel& filter, const EntryCounts& entries, Weights weights, std::span<const Segment> segments,
                 const PixelRect& pixels, double* patch);
inline PixelRect patch_of(const FilterKernel& filter, const PixelRect& pixels) {
    const int margin = filter.side() - 1;
    return {pixels.x0 - margin, pixels.y0 - margin, pixels.x1 + margin, pixels.y1 + margin};
}

// Pins the instructions that `splat` uses: "best", or one of `simd_levels()`. Errors: kUsage, listing them.
Status set_simd_level(std::string_view level);
std::vector<std::string_view>
simd_levels();  // those of base/simd.h that `splat` is compiled for and this processor has, slowest first

}  // namespace latent::develop
