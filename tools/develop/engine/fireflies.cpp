#include "tools/develop/engine/fireflies.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>

namespace latent::develop {

using sampledb::RecordClass;

namespace {

constexpr RecordClass kClasses[] = {RecordClass::kCamera, RecordClass::kLight};

void dim_row(const RowLayout& layout, float factor, float* row) {
    const RowLayout& at = layout;
    for (int c = 0; c < at.channels; ++c) {
        row[c] *= factor;
        if (at.layers.halves) row[at.half() + c] *= factor;
        for (std::size_t group = 0; group < at.lights.size(); ++group) {
            row[at.light(group) + c] *= factor;
            if (at.layers.halves) row[at.light_half(group) + c] *= factor;
        }
        if (at.layers.variance) row[at.squares() + c] *= factor * factor, row[at.products() + c] *= factor;
    }
}

}  // namespace

DimmedLight& DimmedLight::operator+=(const DimmedLight& other) {
    samples += other.samples;
    before += other.before;
    taken += other.taken;
    return *this;
}

Fireflies::Fireflies(const FilmGrid& grid, int reach, const RowLayout& layout, Classes classes, double samples_per_pixel)
    : grid_(grid), reach_(reach), layout_(layout), classes_(classes) {
    for (double samples = samples_per_pixel; samples < kMinSamples && shift_ < 30; samples *= 4) ++shift_;
    const auto count = [&](std::int64_t pixels) { return static_cast<std::size_t>(pixels >> (shift_ - 24)) + 1; };
    columns_ = count(grid.window_width());
    blocks_ = columns_ * count(grid.window_height());
}

std::uint64_t Fireflies::bytes() const {
    const std::uint64_t images = (classes_.camera ? 1 : 0) + (classes_.light ? 1 : 0);
    return (images * blocks_ * sizeof(Block) + 63) / 64 * 64;
}

std::span<Fireflies::Block> Fireflies::blocks(std::size_t cell, RecordClass record_class) const {
    auto* const first = reinterpret_cast<Block*>(memory_.data() + cell * bytes());
    return {first + (record_class == RecordClass::kLight && classes_.camera ? blocks_ : 0), blocks_};
}

float Fireflies::brightness(const float* row) const {
    float sum = 0;
    for (int c = 0; c < layout_.channels; ++c) sum += std::abs(row[c]);
    return sum;
}

void Fireflies::begin(const PixelRect& cells, std::span<std::byte> memory) {
    cells_ = cells;
    memory_ = memory;
    assert(static_cast<std::uint64_t>(cells.width() * cells.height()) * bytes() <= memory.size());
    std::ranges::fill(memory, std::byte{0});
}

void Fireflies::look_at(std::span<const RecordBatch* const> batches, const PageRange& range) {
    tbb::parallel_for(std::size_t{0}, static_cast<std::size_t>(cells_.width() * cells_.height()), [&](std::size_t cell) {
        thread_local std::vector<std::span<const Segment>> found;
        const auto i = static_cast<std::int64_t>(cell);
        for (const RecordClass record_class : kClasses) {
            if (!classes_.has(record_class)) continue;
            const std::span<Block> to = blocks(cell, record_class);
            segments_in_order(batches, range, cells_.x0 + i % cells_.width(), cells_.y0 + i / cells_.width(), record_class, found);
            for (const std::span<const Segment> segments : found) {
                for (const Segment& segment : segments) {
                    const SegmentColumns records = segment.columns();
                    for (std::size_t row = 0; row < segment.count; ++row) {
                        float light = brightness(records.values + row * static_cast<std::size_t>(layout_.stride()));
                        for (float& kept : to[block_of(records.x[row], records.y[row])].brightest) {
                            if (light > kept) std::swap(light, kept);
                        }
                    }
                }
            }
        }
    });
}

void Fireflies::decide() {
    tbb::parallel_for(std::size_t{0}, static_cast<std::size_t>(cells_.width() * cells_.height()), [&](std::size_t cell) {
        for (const RecordClass record_class : kClasses) {
            if (classes_.has(record_class)) decide(cell, record_class);
        }
    });
}

// At the border of the cell, the nine blocks are those nearest to the block that lie inside.
void Fireflies::decide(std::size_t cell, RecordClass record_class) {
    const auto i = static_cast<std::int64_t>(cell);
    const PixelRect window = grid_.window(static_cast<std::uint32_t>(cells_.x0 + i % cells_.width()),
                                          static_cast<std::uint32_t>(cells_.y0 + i / cells_.width()));
    const auto count = [&](std::int64_t pixels) { return static_cast<std::size_t>((pixels - 2 * reach_) >> (shift_ - 24)) + 1; };
    const std::size_t columns = count(window.width()), rows = count(window.height());
    const auto first = [](std::size_t at, std::size_t all) {
        return std::min(at - std::min<std::size_t>(at, 1), all - std::min<std::size_t>(all, 3));
    };
    const std::span<Block> all = blocks(cell, record_class);
    for (std::size_t y = 0; y < rows; ++y) {
        for (std::size_t x = 0; x < columns; ++x) {
            std::array<float, 9 * kTrusted> seen{};
            auto to = seen.begin();
            for (std::size_t v = first(y, rows), last_v = std::min(v + 3, rows); v < last_v; ++v) {
                for (std::size_t u = first(x, columns), last_u = std::min(u + 3, columns); u < last_u; ++u)
                    to = std::ranges::copy(all[v * columns_ + u].brightest, to).out;
            }
            const auto least = seen.begin() + kTrusted - 1;
            std::nth_element(seen.begin(), least, seen.end(), std::greater<>());
            all[y * columns_ + x].limit = kMargin * *least;
        }
    }
}

// The rows of `all` from `first` on that `part` has room for.
DimmedLight Fireflies::copy(std::size_t cell, RecordClass record_class, const Segment& all, std::uint32_t first,
                            const Segment& part) const {
    const auto stride = static_cast<std::size_t>(layout_.stride());
    const SegmentColumns from = all.columns(), to = part.columns();
    std::copy_n(from.x + first, part.count, to.x);
    std::copy_n(from.y + first, part.count, to.y);
    std::copy_n(from.values + first * stride, part.count * stride, to.values);
    const std::span<const Block> limits = blocks(cell, record_class);
    DimmedLight dimmed;
    for (std::size_t i = 0; i < part.count; ++i) {
        float* const row = to.values + i * stride;
        const float light = brightness(row);
        const float limit = limits[block_of(to.x[i], to.y[i])].limit;
        dimmed.before += static_cast<double>(light);
        if (light <= limit) continue;
        dim_row(layout_, limit / light, row);
        dimmed.taken += static_cast<double>(light) - static_cast<double>(limit);
        ++dimmed.samples;
    }
    return dimmed;
}

}  // namespace latent::develop
