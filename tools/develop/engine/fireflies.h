// tools/develop/engine/fireflies.h: lone samples that are far brighter than all around them, and how they are dimmed.
// docs/developing.md, "Fireflies".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tools/develop/channels/layers.h"
#include "tools/develop/engine/record_batch.h"
#include "tools/develop/engine/regions.h"
#include "tools/develop/film/film_grid.h"

namespace latent::develop {

// What dimming did to the samples of an image; brightness is the sum of a sample's channels.
struct DimmedLight {
    std::uint64_t samples = 0;  // that were dimmed
    double before = 0, taken = 0;

    DimmedLight& operator+=(const DimmedLight& other);
    double share() const { return before > 0 ? taken / before : 0; }
};

// Fireflies in the cells of a pane. Samples count by blocks of pixels, each cell by itself, camera and light records apart: so the
// order and the batches in which they come make no difference.
class Fireflies {
 public:
    // A sample is trusted up to kMargin times the brightness that kTrusted samples of its own and the 8 blocks around have.
    static constexpr int kTrusted = 4;
    static constexpr float kMargin = 2;
    static constexpr double kMinSamples = 64;  // in a block

    Fireflies(const FilmGrid& grid, int reach, const RowLayout& layout, Classes classes, double samples_per_pixel);

    std::uint64_t bytes() const;  // for one cell
    void begin(const PixelRect& cells, std::span<std::byte> memory);
    void look_at(std::span<const RecordBatch* const> batches, const PageRange& range);
    void decide();  // after all records were looked at

    // Hands the records of a cell of the pane to `use(segments)` in their order, some at a time, dimmed. Thread-safe.
    template <class Use>
    DimmedLight dim(std::int64_t cell_x, std::int64_t cell_y, sampledb::RecordClass record_class,
                    std::span<const std::span<const Segment>> found, const Use& use) const {
        DimmedLight dimmed;
        thread_local std::vector<std::byte> memory;
        memory.resize(SegmentColumns::bytes(kRowsAtOnce, static_cast<std::size_t>(layout_.stride())) + Segment::kReadable);
        for (const std::span<const Segment> segments : found) {
            for (const Segment& segment : segments) {
                for (std::uint32_t done = 0; done < segment.count; done += kRowsAtOnce) {
                    const Segment part{segment.page, memory.data(), std::min(kRowsAtOnce, segment.count - done)};
                    dimmed += copy(cell_of(cell_x, cell_y), record_class, segment, done, part);
                    use(std::span(&part, 1));
                }
            }
        }
        return dimmed;
    }

 private:
    static constexpr std::uint32_t kRowsAtOnce = 1024;
    struct Block {
        float brightest[kTrusted];  // its brightest samples, in descending order
        float limit;
    };

    std::size_t cell_of(std::int64_t x, std::int64_t y) const {
        return static_cast<std::size_t>((y - cells_.y0) * cells_.width() + (x - cells_.x0));
    }
    std::span<Block> blocks(std::size_t cell, sampledb::RecordClass record_class) const;
    std::size_t block_of(std::uint32_t x, std::uint32_t y) const { return (y >> shift_) * columns_ + (x >> shift_); }
    float brightness(const float* row) const;
    void decide(std::size_t cell, sampledb::RecordClass record_class);
    DimmedLight copy(std::size_t cell, sampledb::RecordClass record_class, const Segment& all, std::uint32_t first,
                     const Segment& part) const;

    const FilmGrid& grid_;
    int reach_;
    RowLayout layout_;
    Classes classes_;
    int shift_ = 24;  // from positions of SegmentColumns to blocks
    std::size_t columns_, blocks_;
    PixelRect cells_;
    std::span<std::byte> memory_;
};

// Hands the records that were found of a cell to `use`, as `dim` does, or as they are where there is nothing to dim.
template <class Use>
DimmedLight pass_on(const Fireflies* fireflies, std::int64_t cell_x, std::int64_t cell_y, sampledb::RecordClass record_class,
                    std::span<const std::span<const Segment>> found, const Use& use) {
    if (fireflies) return fireflies->dim(cell_x, cell_y, record_class, found, use);
    for (const std::span<const Segment> segments : found) use(segments);
    return {};
}

}  // namespace latent::develop
