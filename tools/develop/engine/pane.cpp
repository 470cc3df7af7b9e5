#include "tools/develop/engine/pane.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <vector>

#include "tools/develop/kernel/splat.h"

namespace latent::develop {

using sampledb::RecordClass;

Pane::Pane(const FilmGrid& grid, const FilterKernel& filter, const EntryCounts& entries, Classes classes,
           std::optional<Fireflies> fireflies)
    : grid_(grid), filter_(filter), entries_(entries), classes_(classes), fireflies_(std::move(fireflies)) {
    const std::uint64_t images = (classes.camera ? 1 : 0) + (classes.light ? 1 : 0);
    const std::uint64_t pixels = static_cast<std::uint64_t>(grid.window_width() * grid.window_height());
    window_bytes_ = (pixels * images * static_cast<std::uint64_t>(entries.stride()) * sizeof(double) + 63) / 64 * 64;
}

void Pane::begin(const PixelRect& cells, std::span<std::byte> memory) {
    assert(bytes(cells) <= memory.size());
    memory_ = memory;
    windows_ = {cells, std::vector<Windows::Cell>(static_cast<std::size_t>(cells.width() * cells.height()))};
    dimmed_.assign(2 * windows_.of.size(), {});
    if (fireflies_)
        fireflies_->begin(cells, memory.subspan(windows_.of.size() * window_bytes_, windows_.of.size() * fireflies_->bytes()));
}

void Pane::add_records(std::span<const RecordBatch* const> batches, const PageRange& range, const Stopped& stopped) {
    tbb::parallel_for(std::size_t{0}, windows_.of.size(), [&](std::size_t cell) {
        if (!is_true(stopped)) add_to_cell(cell, batches, range);
    });
}

DimmedLight Pane::dimmed(RecordClass record_class) const {
    DimmedLight all;
    for (std::size_t i = record_class == RecordClass::kLight ? 1 : 0; i < dimmed_.size(); i += 2) all += dimmed_[i];
    return all;
}

void Pane::add_to_cell(std::size_t cell, std::span<const RecordBatch* const> batches, const PageRange& range) {
    const std::int64_t x = windows_.cells.x0 + static_cast<std::int64_t>(cell) % windows_.cells.width();
    const std::int64_t y = windows_.cells.y0 + static_cast<std::int64_t>(cell) / windows_.cells.width();
    const PixelRect window = grid_.window(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
    const std::size_t sums =
        static_cast<std::size_t>(window.width() * window.height()) * static_cast<std::size_t>(entries_.stride());
    thread_local std::vector<std::span<const Segment>> found;
    const auto add = [&](RecordClass record_class, Weights weights, double* to, const double*& used) {
        segments_in_order(batches, range, x, y, record_class, found);
        if (found.empty()) return;
        if (!used) std::fill_n(to, sums, 0.0);
        used = to;
        const auto splat_some = [&](std::span<const Segment> segments) {
            splat(filter_, entries_, weights, segments, to, static_cast<std::size_t>(window.width()));
        };
        dimmed_[2 * cell + (record_class == RecordClass::kLight ? 1 : 0)] +=
            pass_on(fireflies(), x, y, record_class, found, splat_some);
    };
    auto* const camera = reinterpret_cast<double*>(memory_.data() + cell * window_bytes_);
    add(RecordClass::kCamera, Weights::kSigned, camera, windows_.of[cell].camera);
    add(RecordClass::kLight, Weights::kUnitSum, camera + (classes_.camera ? sums : 0), windows_.of[cell].light);
}

}  // namespace latent::develop
