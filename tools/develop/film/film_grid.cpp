#include "tools/develop/film/film_grid.h"

#include <algorithm>
#include <bit>

namespace latent::develop {

namespace {

int level_of_cells(std::uint32_t width, std::uint32_t height) {
    int level = 0;
    while ((std::uint64_t{FilmGrid::kCellPixels} << level) < std::max(width, height)) ++level;
    return level;
}

}  // namespace

PixelRect intersection(const PixelRect& a, const PixelRect& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

FilmGrid::Axis::Axis(std::uint32_t pixel_count, int level, int reach) : pixels(pixel_count), extent(0) {
    const std::uint64_t cells = std::uint64_t{1} << level, side = std::uint64_t{1} << (32 - level);
    begin.reserve(cells);
    end.reserve(cells);
    origin.reserve(cells);
    for (std::uint64_t c = 0; c < cells; ++c) {  // a record at position p has j = floor(p pixels + 1/2): columns j - n .. j + n - 1
        const auto first = static_cast<std::int64_t>((c * side * pixels + 0x80000000u) >> 32);
        const auto last = static_cast<std::int64_t>((((c + 1) * side - 1) * pixels + 0x80000000u) >> 32);
        begin.push_back(first - reach);
        end.push_back(last + reach);
        origin.push_back(static_cast<std::uint32_t>(first << 24));
        extent = std::max(extent, end.back() - begin.back());
    }
}

void FilmGrid::Axis::cells_reaching(std::int64_t from, std::int64_t to, std::int64_t& first, std::int64_t& last) const {
    first = std::upper_bound(end.begin(), end.end(), from) - end.begin();
    last = std::lower_bound(begin.begin(), begin.end(), to) - begin.begin();
}

void FilmGrid::Axis::inner_pixels(std::int64_t first, std::int64_t last, std::int64_t& from, std::int64_t& to) const {
    from = first > 0 ? end[first - 1] : begin.front();
    to = last < static_cast<std::int64_t>(begin.size()) ? begin[last] : end.back();
}

void FilmGrid::Axis::inner_cells(std::int64_t first, std::int64_t last, std::int64_t& from, std::int64_t& to) const {
    std::int64_t from_pixel, to_pixel;
    inner_pixels(first, last, from_pixel, to_pixel);
    from = std::max(first, std::lower_bound(begin.begin(), begin.end(), from_pixel) - begin.begin());
    to = std::min(last, std::upper_bound(end.begin(), end.end(), to_pixel) - end.begin());
}

void FilmGrid::Axis::bands(std::int64_t from, std::int64_t to, std::vector<Band>& bands) const {
    bands.clear();
    Band band{from, from, 0, 0};
    if (from < to) cells_reaching(from, from + 1, band.first, band.last);
    const auto cells = static_cast<std::int64_t>(begin.size());
    while (band.from < to) {  // until the first of its cells ends or the next one begins
        band.to = std::min(to, end[band.first]);
        if (band.last < cells) band.to = std::min(band.to, begin[band.last]);
        bands.push_back(band);
        band.from = band.to;
        while (band.first < cells && end[band.first] <= band.from) ++band.first;
        while (band.last < cells && begin[band.last] <= band.from) ++band.last;
    }
}

FilmGrid::FilmGrid(std::uint32_t width, std::uint32_t height, int reach)
    : level_(level_of_cells(width, height)), x_(width, level_, reach), y_(height, level_, reach) {}

PixelRect FilmGrid::cells_reaching(const PixelRect& pixels) const {
    PixelRect cells;
    x_.cells_reaching(pixels.x0, pixels.x1, cells.x0, cells.x1);
    y_.cells_reaching(pixels.y0, pixels.y1, cells.y0, cells.y1);
    return cells;
}

PixelRect FilmGrid::inner_pixels(const PixelRect& cells) const {
    PixelRect pixels;
    x_.inner_pixels(cells.x0, cells.x1, pixels.x0, pixels.x1);
    y_.inner_pixels(cells.y0, cells.y1, pixels.y0, pixels.y1);
    return pixels;
}

PixelRect FilmGrid::inner_cells(const PixelRect& cells) const {
    PixelRect inner;
    x_.inner_cells(cells.x0, cells.x1, inner.x0, inner.x1);
    y_.inner_cells(cells.y0, cells.y1, inner.y0, inner.y1);
    return inner;
}

PixelRect FilmGrid::cells_of(const sampledb::FilmNode& node) const {
    if (node.level >= level_) {
        const int coarser = node.level - level_;
        const auto x = static_cast<std::int64_t>(std::uint64_t{node.x} >> coarser);
        const auto y = static_cast<std::int64_t>(std::uint64_t{node.y} >> coarser);
        return {x, y, x + 1, y + 1};
    }
    const int finer = level_ - node.level;
    return {std::int64_t{node.x} << finer, std::int64_t{node.y} << finer, (std::int64_t{node.x} + 1) << finer,
            (std::int64_t{node.y} + 1) << finer};
}

sampledb::FilmNode FilmGrid::node_about(const PixelRect& cells) const {
    const auto differing = static_cast<std::uint64_t>((cells.x0 ^ (cells.x1 - 1)) | (cells.y0 ^ (cells.y1 - 1)));
    const int above = std::bit_width(differing);  // levels
    return {static_cast<std::uint8_t>(level_ - above), static_cast<std::uint32_t>(cells.x0 >> above),
            static_cast<std::uint32_t>(cells.y0 >> above)};
}

}  // namespace latent::develop
