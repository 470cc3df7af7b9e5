// tools/develop/engine/regions.h: the regions of the film, each small enough for the memory. docs/developing.md, "Regions".
#pragma once

#include <cstdint>
#include <vector>

#include "sampledb/read/run_set.h"
#include "tools/develop/engine/record_batch.h"
#include "tools/develop/film/film_grid.h"

namespace latent::develop {

// The first and one past the last code on the Z curve of a node's cells.
struct ZRange {
    std::uint64_t begin, end;
};
ZRange z_range(const FilmGrid& grid, const sampledb::FilmNode& node);
sampledb::FilmNode child(const sampledb::FilmNode& node, int i);  // 0..3 in Z order

// Whether a record class is developed at all.
struct Classes {
    bool camera = true, light = true;
    bool has(sampledb::RecordClass c) const { return c == sampledb::RecordClass::kCamera ? camera : light; }
};

// How a node is developed. `kResident`: all its records fit into memory; they are decoded at once, and the windows of a few cells
// at a time are filled and finished. `kStreaming`: the windows of all its cells fit; the records pass by in batches. `kSplit`: its
// children one after another.
enum class Way { kResident, kStreaming, kSplit };

// Plans with upper bounds of the bytes that the records of pages take once they are decoded, counted by the pages' nodes.
class Plan {
 public:
    // What a cell takes: its window, and sums with the non-negative part of the filter (0: no pixel needs them).
    struct CellBytes {
        std::uint64_t window, positive;
    };
    // Plans all pages that reach into `needed` (cells).
    static Result<Plan> make(const sampledb::RunSet& run_set, const FilmGrid& grid, const PixelRect& needed, Classes classes,
                             const Loader& loader, const CellBytes& cell_bytes);

    // Cells of a node that are needed; if there are none, it needs no way.
    PixelRect cells(const sampledb::FilmNode& node) const { return intersection(grid_->cells_of(node), needed_); }
    // For a node in `room` bytes. `missed`: bytes of records in the pages of its ancestors that are not in memory.
    Way way(const sampledb::FilmNode& node, std::uint64_t room, std::uint64_t missed) const;
    // Whether the records of a split node's own pages, those that lie in none of its children, should be in memory while the
    // children are developed. That leaves them less room, which may cut them into more regions.
    bool holds(const sampledb::FilmNode& node, std::uint64_t room, std::uint64_t missed) const;
    std::uint64_t own(const sampledb::FilmNode& node) const;  // bytes of their records

    // About how many times each byte of records is decoded with so much room for the whole film, on average.
    double decode_factor(std::uint64_t room) const;

    std::uint64_t min_batch() const { return min_batch_; }  // bytes
    std::uint64_t min_room() const { return min_batch_ + cell_bytes_.window + cell_bytes_.positive; }
    std::uint64_t pages() const { return pages_; }
    std::uint64_t stored_bytes() const { return stored_bytes_; }  // the pages on disk
    double segments() const { return segments_; }                 // that they will make, about

 private:
    Plan(const FilmGrid& grid, const PixelRect& needed, const CellBytes& cell_bytes, std::uint64_t runs);
    std::uint64_t window_bytes(const PixelRect& cells) const;  // for a region that streams
    std::uint64_t inside(const sampledb::FilmNode& node) const;
    // Bytes of records in the pages of a node's ancestors that are not in memory, and those that are decoded for it.
    struct Missed {
        std::uint64_t all = 0, decoded = 0;
    };
    struct Split {
        bool holds;
        std::uint64_t decoded;  // bytes of records, repeats included
    };
    Split best_split(const sampledb::FilmNode& node, std::uint64_t room, const Missed& missed) const;
    std::uint64_t decoded(const sampledb::FilmNode& node, std::uint64_t room, const Missed& missed) const;

    const FilmGrid* grid_;
    PixelRect needed_;
    CellBytes cell_bytes_;
    std::uint64_t runs_;
    std::vector<std::vector<std::uint64_t>> inside_;  // bytes of records of pages that lie in a node, by level and Z order
    double reach_ = 1;                                // share of its node's children that a page lies in, on average
    std::uint64_t min_batch_, pages_ = 0, stored_bytes_ = 0;
    double segments_ = 0;
};

}  // namespace latent::develop
