// tools/develop/engine/positive.h: sums with the non-negative part of the filter, for the few pixels that need them.
// docs/developing.md, "Few samples".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tools/develop/engine/fireflies.h"
#include "tools/develop/engine/record_batch.h"
#include "tools/develop/film/film_grid.h"
#include "tools/develop/film/filter.h"

namespace latent::develop {

class PositiveSums {
 public:
    virtual ~PositiveSums() = default;
    // Adds what the camera records of a cell of the pane give to `pixels`, which lie in its window, to their sums, row after row.
    // Thread-safe.
    virtual void add(std::int64_t cell_x, std::int64_t cell_y, const PixelRect& pixels, std::span<double> sums) const = 0;
};

// From records in memory, looked through again.
class PositiveFromRecords final : public PositiveSums {
 public:
    PositiveFromRecords(const FilmGrid& grid, const FilterKernel& filter, const EntryCounts& entries, const Fireflies* fireflies,
                        std::span<const RecordBatch* const> batches)
        : grid_(grid), filter_(filter), entries_(entries), stride_(entries.stride()), fireflies_(fireflies), batches_(batches) {}
    void add(std::int64_t cell_x, std::int64_t cell_y, const PixelRect& pixels, std::span<double> sums) const override;

 private:
    const FilmGrid& grid_;
    const FilterKernel& filter_;
    EntryCounts entries_;
    int stride_;
    const Fireflies* fireflies_;
    std::span<const RecordBatch* const> batches_;
};

// From windows that are filled while records pass by in batches. Those of the cells at the pane's border hold the pixels that other
// cells reach too; those of cells that were asked for hold all pixels.
class PositiveWindows final : public PositiveSums {
 public:
    PositiveWindows(const FilmGrid& grid, const FilterKernel& filter, const EntryCounts& entries, const Fireflies* fireflies,
                    const PixelRect& cells);

    static std::uint64_t bytes(const FilmGrid& grid, int stride);                                 // for one window
    static std::uint64_t border_bytes(const FilmGrid& grid, int stride, const PixelRect& cells);  // for those at a pane's border
    void open_border(std::span<std::byte> memory);
    // Bytes that windows of `cells` (numbers in the pane, ascending) need beside those that are open.
    std::uint64_t bytes_beside(std::span<const std::size_t> cells) const;
    // Begins all pixels of these cells anew.
    void open(std::span<const std::size_t> cells, std::span<std::byte> memory);

    // Adds the records of the pages in `range` to the open windows.
    void add_records(std::span<const RecordBatch* const> batches, const PageRange& range);
    void add(std::int64_t cell_x, std::int64_t cell_y, const PixelRect& pixels, std::span<double> sums) const override;

 private:
    struct Window {
        double* sums = nullptr;
        bool whole = false;  // all pixels
    };
    std::int64_t cell_x(std::size_t cell) const { return cells_.x0 + static_cast<std::int64_t>(cell) % cells_.width(); }
    std::int64_t cell_y(std::size_t cell) const { return cells_.y0 + static_cast<std::int64_t>(cell) / cells_.width(); }
    PixelRect window(std::size_t cell) const;
    void add_to_border(std::size_t cell, std::span<const std::span<const Segment>> found);

    const FilmGrid& grid_;
    const FilterKernel& filter_;
    EntryCounts entries_;
    int stride_;
    const Fireflies* fireflies_;
    PixelRect cells_, inner_;  // pixels that no cell outside reaches
    std::vector<Window> windows_;
    bool only_whole_ = false;
};

}  // namespace latent::develop
