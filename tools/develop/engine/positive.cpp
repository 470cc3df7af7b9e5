#include "tools/develop/engine/positive.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>

#include "tools/develop/kernel/splat.h"

namespace latent::develop {

namespace {

constexpr sampledb::RecordClass kCamera = sampledb::RecordClass::kCamera;
constexpr std::int64_t kLongestStrip = 64;  // pixels of a patch, in both directions

std::size_t size_of(const PixelRect& pixels, int stride) {
    return static_cast<std::size_t>(pixels.width() * pixels.height()) * static_cast<std::size_t>(stride);
}

// Visits the part of two arrays of sums over rectangles that lies in `pixels`: visit(in from, in to, doubles) for each row.
template <class From, class To, class Visit>
void for_rows(const PixelRect& pixels, int stride, const PixelRect& from_rect, From* from, const PixelRect& to_rect, To* to,
              const Visit& visit) {
    for (std::int64_t y = pixels.y0; y < pixels.y1; ++y) {
        visit(from + ((y - from_rect.y0) * from_rect.width() + pixels.x0 - from_rect.x0) * stride,
              to + ((y - to_rect.y0) * to_rect.width() + pixels.x0 - to_rect.x0) * stride, pixels.width() * stride);
    }
}

void copy_doubles(const double* from, double* to, std::int64_t count) { std::copy_n(from, count, to); }

PixelRect moved(const PixelRect& r, std::int64_t x, std::int64_t y) { return {r.x0 + x, r.y0 + y, r.x1 + x, r.y1 + y}; }

// Pieces of `pixels` that are small enough for a patch.
template <class Visit>
void for_patches(const PixelRect& pixels, const Visit& visit) {
    for (std::int64_t y = pixels.y0; y < pixels.y1; y += kLongestStrip) {
        for (std::int64_t x = pixels.x0; x < pixels.x1; x += kLongestStrip)
            visit(intersection({x, y, x + kLongestStrip, y + kLongestStrip}, pixels));
    }
}

}  // namespace

void PositiveFromRecords::add(std::int64_t cell_x, std::int64_t cell_y, const PixelRect& pixels, std::span<double> sums) const {
    thread_local std::vector<std::span<const Segment>> found;
    thread_local std::vector<double> patch;
    segments_in_order(batches_, {}, cell_x, cell_y, kCamera, found);
    if (found.empty()) return;
    const PixelRect window = grid_.window(static_cast<std::uint32_t>(cell_x), static_cast<std::uint32_t>(cell_y));
    for_patches(pixels, [&](const PixelRect& part) {
        const PixelRect reach = patch_of(filter_, part);
        patch.assign(size_of(reach, stride_), 0.0);
        pass_on(fireflies_, cell_x, cell_y, kCamera, found, [&](std::span<const Segment> segments) {
            splat_patch(filter_, entries_, Weights::kPositive, segments, moved(part, -window.x0, -window.y0), patch.data());
        });
        for_rows(part, stride_, reach, static_cast<const double*>(patch.data()), pixels, sums.data(),
                 [&](const double* from, double* to, std::int64_t count) { add_sums(entries_, from, to, count); });
    });
}

PositiveWindows::PositiveWindows(const FilmGrid& grid, const FilterKernel& filter, const EntryCounts& entries,
                                 const Fireflies* fireflies, const PixelRect& cells)
    : grid_(grid),
      filter_(filter),
      entries_(entries),
      stride_(entries.stride()),
      fireflies_(fireflies),
      cells_(cells),
      inner_(grid.inner_pixels(cells)),
      windows_(static_cast<std::size_t>(cells.width() * cells.height())) {}

std::uint64_t PositiveWindows::bytes(const FilmGrid& grid, int stride) {
    const std::uint64_t pixels = static_cast<std::uint64_t>(grid.window_width() * grid.window_height());
    return (pixels * static_cast<std::uint64_t>(stride) * sizeof(double) + 63) / 64 * 64;
}

std::uint64_t PositiveWindows::border_bytes(const FilmGrid& grid, int stride, const PixelRect& cells) {
    const PixelRect inner = grid.inner_cells(cells);
    const std::int64_t inside = inner.empty() ? 0 : inner.width() * inner.height();
    return static_cast<std::uint64_t>(cells.width() * cells.height() - inside) * bytes(grid, stride);
}

PixelRect PositiveWindows::window(std::size_t cell) const {
    return grid_.window(static_cast<std::uint32_t>(cell_x(cell)), static_cast<std::uint32_t>(cell_y(cell)));
}

void PositiveWindows::open_border(std::span<std::byte> memory) {
    const std::uint64_t each = bytes(grid_, stride_);
    auto* at = memory.data();
    for (std::size_t cell = 0; cell < windows_.size(); ++cell) {
        const PixelRect pixels = window(cell);
        if (intersection(pixels, inner_) == pixels) continue;
        windows_[cell].sums = reinterpret_cast<double*>(at);
        std::fill_n(windows_[cell].sums, size_of(pixels, stride_), 0.0);
        at += each;
    }
    assert(at <= memory.data() + memory.size());
}

std::uint64_t PositiveWindows::bytes_beside(std::span<const std::size_t> cells) const {
    const auto closed = std::ranges::count_if(cells, [&](std::size_t cell) { return !windows_[cell].sums; });
    return static_cast<std::uint64_t>(closed) * bytes(grid_, stride_);
}

void PositiveWindows::open(std::span<const std::size_t> cells, std::span<std::byte> memory) {
    auto* at = memory.data();
    for (const std::size_t cell : cells) {
        if (!windows_[cell].sums) {
            windows_[cell].sums = reinterpret_cast<double*>(at);
            at += bytes(grid_, stride_);
        }
        windows_[cell].whole = true;
        std::fill_n(windows_[cell].sums, size_of(window(cell), stride_), 0.0);
    }
    assert(at <= memory.data() + memory.size());
    only_whole_ = true;
}

void PositiveWindows::add_records(std::span<const RecordBatch* const> batches, const PageRange& range) {
    tbb::parallel_for(std::size_t{0}, windows_.size(), [&](std::size_t cell) {
        if (!windows_[cell].sums || windows_[cell].whole != only_whole_) return;
        thread_local std::vector<std::span<const Segment>> found;
        segments_in_order(batches, range, cell_x(cell), cell_y(cell), kCamera, found);
        if (!windows_[cell].whole) return add_to_border(cell, found);
        const auto splat_some = [&](std::span<const Segment> segments) {
            splat(filter_, entries_, Weights::kPositive, segments, windows_[cell].sums,
                  static_cast<std::size_t>(window(cell).width()));
        };
        pass_on(fireflies_, cell_x(cell), cell_y(cell), kCamera, found, splat_some);
    });
}

// The frame that surrounds `inner_`, each sum going on from where the batch before left it.
void PositiveWindows::add_to_border(std::size_t cell, std::span<const std::span<const Segment>> found) {
    const PixelRect all = window(cell), inside = intersection(all, inner_);
    PixelRect frame[] = {{all.x0, all.y0, all.x1, inside.y0},
                         {all.x0, inside.y1, all.x1, all.y1},
                         {all.x0, inside.y0, inside.x0, inside.y1},
                         {inside.x1, inside.y0, all.x1, inside.y1}};
    if (inside.empty()) frame[0] = all, frame[1] = frame[2] = frame[3] = {};
    thread_local std::vector<double> patch;
    double* const sums = windows_[cell].sums;
    for (const PixelRect& strip : frame) {
        for_patches(strip, [&](const PixelRect& part) {
            const PixelRect reach = patch_of(filter_, part);
            patch.assign(size_of(reach, stride_), 0.0);
            for_rows(part, stride_, all, static_cast<const double*>(sums), reach, patch.data(), copy_doubles);
            const auto splat_some = [&](std::span<const Segment> segments) {
                splat_patch(filter_, entries_, Weights::kPositive, segments, moved(part, -all.x0, -all.y0), patch.data());
            };
            pass_on(fireflies_, cell_x(cell), cell_y(cell), kCamera, found, splat_some);
            for_rows(part, stride_, reach, static_cast<const double*>(patch.data()), all, sums, copy_doubles);
        });
    }
}

void PositiveWindows::add(std::int64_t cell_x, std::int64_t cell_y, const PixelRect& pixels, std::span<double> sums) const {
    const auto cell = static_cast<std::size_t>((cell_y - cells_.y0) * cells_.width() + (cell_x - cells_.x0));
    const Window& held = windows_[cell];
    assert(held.sums);
    for_rows(pixels, stride_, window(cell), static_cast<const double*>(held.sums), pixels, sums.data(),
             [&](const double* from, double* to, std::int64_t count) { add_sums(entries_, from, to, count); });
}

}  // namespace latent::develop
