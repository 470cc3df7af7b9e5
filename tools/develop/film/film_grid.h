// tools/develop/film/film_grid.h: the image as pixels and as cells. docs/developing.md, "Cells".
#pragma once

#include <cstdint>
#include <vector>

#include "sampledb/data/page.h"
#include "tools/develop/film/positions.h"

namespace latent::develop {

// Pixels x0 .. x1-1, y0 .. y1-1.
struct PixelRect {
    std::int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    std::int64_t width() const { return x1 - x0; }
    std::int64_t height() const { return y1 - y0; }
    bool empty() const { return x1 <= x0 || y1 <= y0; }
    bool operator==(const PixelRect&) const = default;
};
PixelRect intersection(const PixelRect& a, const PixelRect& b);

// Cells are the dyadic squares of the film at the coarsest level where both sides are at most kCellPixels pixels. The cell of a
// record is a prefix of its position, whatever the image size. Each cell is accumulated by itself, in a window that exceeds it by
// the reach of the filter, and in the order of its records; windows are added up in the order of the Z curve. Neither depends on
// anything but the records, the image size and the filter.
class FilmGrid {
 public:
    static constexpr std::uint32_t kCellPixels = 64;

    FilmGrid(std::uint32_t width, std::uint32_t height, int reach);

    std::uint32_t width() const { return x_.pixels; }
    std::uint32_t height() const { return y_.pixels; }
    int level() const { return level_; }

    // Pixels that records of cell (x, y) reach, beyond the film's border too.
    PixelRect window(std::uint32_t cell_x, std::uint32_t cell_y) const {
        return {x_.begin[cell_x], y_.begin[cell_y], x_.end[cell_x], y_.end[cell_y]};
    }
    // The largest width and height of a window.
    std::int64_t window_width() const { return x_.extent; }
    std::int64_t window_height() const { return y_.extent; }

    // Cells (as x0..x1-1, y0..y1-1) whose windows meet `pixels`, which lie on the film.
    PixelRect cells_reaching(const PixelRect& pixels) const;
    // The pixels that no cell outside of these reaches, beyond the film's border too; and the cells whose windows lie
    // in them.
    PixelRect inner_pixels(const PixelRect& cells) const;
    PixelRect inner_cells(const PixelRect& cells) const;

    // Pixels from .. to-1 along an axis that the cells first .. last-1 reach, all of them and no others.
    struct Band {
        std::int64_t from, to, first, last;
    };
    // The bands of pixels from .. to-1, which lie on the film, in their order.
    void bands_x(std::int64_t from, std::int64_t to, std::vector<Band>& bands) const { x_.bands(from, to, bands); }
    void bands_y(std::int64_t from, std::int64_t to, std::vector<Band>& bands) const { y_.bands(from, to, bands); }
    // Cells of a node of the film that is no smaller than a cell; for a smaller one, the cell that it lies in.
    PixelRect cells_of(const sampledb::FilmNode& node) const;
    PixelRect cells_of(const PositionRect& positions) const {
        return {cell_of(positions.u.from), cell_of(positions.v.from), std::int64_t{cell_of(positions.u.to)} + 1,
                std::int64_t{cell_of(positions.v.to)} + 1};
    }
    // The smallest node that holds these cells, no smaller than a cell.
    sampledb::FilmNode node_about(const PixelRect& cells) const;

    std::uint32_t cell_of(std::uint32_t position) const { return level_ == 0 ? 0 : position >> (32 - level_); }
    // Where a position lies in the window of its cell, as the splat kernels take it: 8 bits of column and 24 bits of g (filter.h).
    struct Place {
        std::uint32_t pixels, origin;  // the film's, and the window's in units of 2^-24 pixels, mod 2^32
        std::uint32_t operator()(std::uint32_t position) const {
            return static_cast<std::uint32_t>((std::uint64_t{position} * pixels + 0x80000000u) >> 8) - origin;
        }
    };
    Place place_x(std::uint32_t cell_x) const { return {x_.pixels, x_.origin[cell_x]}; }
    Place place_y(std::uint32_t cell_y) const { return {y_.pixels, y_.origin[cell_y]}; }

 private:
    struct Axis {
        std::uint32_t pixels;
        std::vector<std::int64_t> begin, end;  // each cell's window
        std::vector<std::uint32_t> origin;     // each cell's, in units of 2^-24 pixels, mod 2^32
        std::int64_t extent;

        Axis(std::uint32_t pixels, int level, int reach);
        void cells_reaching(std::int64_t from, std::int64_t to, std::int64_t& first, std::int64_t& last) const;
        void inner_pixels(std::int64_t first, std::int64_t last, std::int64_t& from, std::int64_t& to) const;
        void inner_cells(std::int64_t first, std::int64_t last, std::int64_t& from, std::int64_t& to) const;
        void bands(std::int64_t from, std::int64_t to, std::vector<Band>& bands) const;
    };

    int level_;
    Axis x_, y_;
};

}  // namespace latent::develop
