// tools/develop/engine/pane.h: records are added to the windows of a pane's cells. docs/developing.md, "Cells".
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "base/progress.h"
#include "tools/develop/engine/fireflies.h"
#include "tools/develop/engine/record_batch.h"
#include "tools/develop/engine/regions.h"
#include "tools/develop/film/film_grid.h"
#include "tools/develop/film/filter.h"
#include "tools/develop/film/windows.h"

namespace latent::develop {

class Pane {
 public:
    Pane(const FilmGrid& grid, const FilterKernel& filter, const EntryCounts& entries, Classes classes,
         std::optional<Fireflies> fireflies);

    std::uint64_t cell_bytes() const { return window_bytes_ + (fireflies_ ? fireflies_->bytes() : 0); }  // that one cell takes
    std::uint64_t bytes(const PixelRect& cells) const {
        return static_cast<std::uint64_t>(cells.width() * cells.height()) * cell_bytes();
    }

    void begin(const PixelRect& cells, std::span<std::byte> memory);
    // Null: nothing is dimmed. Else it must have looked at all records, and decided, before any are added.
    Fireflies* fireflies() { return fireflies_ ? &*fireflies_ : nullptr; }
    // Adds the records of the pages in `range`, cell by cell, those of one cell in the order of their pages.
    void add_records(std::span<const RecordBatch* const> batches, const PageRange& range, const Stopped& stopped);
    const Windows& windows() const { return windows_; }
    // The dimmed light of the camera or light records that were added since `begin`.
    DimmedLight dimmed(sampledb::RecordClass record_class) const;

 private:
    void add_to_cell(std::size_t cell, std::span<const RecordBatch* const> batches, const PageRange& range);

    const FilmGrid& grid_;
    const FilterKernel& filter_;
    EntryCounts entries_;
    Classes classes_;
    std::optional<Fireflies> fireflies_;
    std::vector<DimmedLight> dimmed_;  // each cell's, camera and light
    std::uint64_t window_bytes_;
    std::span<std::byte> memory_;
    Windows windows_;
};

}  // namespace latent::develop
