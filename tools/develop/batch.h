// tools/develop/batch.h: decoded records of many pages, sorted into cells. docs/developing.md, "Batches".
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

#include "sampledb/gathering.h"
#include "tools/develop/channels.h"
#include "tools/develop/film_grid.h"
#include "tools/develop/splat.h"

namespace latent::develop {

// A page by its place in the order in which records are added up: by run, then along the run's Z order.
struct PageRef {
    std::uint32_t run;
    std::uint32_t index;  // of gathering.pages(run)
    sampledb::PageInfo info;
};

struct DecodeCounts {
    std::atomic<std::uint64_t> pages = 0, bytes = 0;  // decoded, repeats included
    std::atomic<std::uint64_t> camera_not_finite = 0, light_not_finite = 0;
};

// Decodes pages in parallel and keeps the records that lie in the cells of one region, each cell's in the order of pages and rows.
// Pages that reach into regions to come are kept (what is left of them), as long as the memory for that lasts, so that they need
// not be decoded again.
class Batch {
 public:
    Batch(const sampledb::Gathering& gathering, const FilmGrid& grid, const Channels& channels, std::uint64_t carry_bytes);

    // Bytes that a page needs at most.
    std::uint64_t bytes_at_most(const sampledb::PageInfo& page, const PixelRect& cells) const;
    // Loads as many of `pages` as fit into `memory` (at least one); returns how many. `cells`: the region's; `needed_later`: cells
    // whose code on the Z curve is at least `z_end` and which lie in `needed` will be asked for later.
    Result<std::size_t> load(std::span<const PageRef> pages, std::span<std::byte> memory, const PixelRect& cells,
                             const PixelRect& needed, std::uint64_t z_end);
    void clear();

    RecordColumns columns() const { return {x_, y_, values_}; }
    std::span<const Segment> segments(std::int64_t cell_x, std::int64_t cell_y, sampledb::RecordClass record_class) const;
    // Pages that no region from `z_end` on needs are forgotten.
    void forget_before(std::uint64_t z_end);

    const DecodeCounts& counts() const { return counts_; }

 private:
    struct CellRows {  // rows first .. first + count - 1 of a page or of the batch lie in one cell
        std::uint32_t cell_x, cell_y, first, count;
    };
    struct Carried {
        std::vector<CellRows> cells;
        std::vector<std::uint32_t> x, y;
        std::vector<float> values;
        std::uint64_t last_z;
        std::uint64_t bytes;
    };
    struct Region {
        PixelRect cells, needed;
        std::uint64_t z_end;
    };

    Status load_page(const PageRef& page, const Region& region, std::vector<CellRows>& kept);
    void find_cells(const sampledb::Page& page, std::vector<CellRows>& cells) const;
    void copy_rows(const sampledb::Page& page, const CellRows& rows, std::uint32_t* x, std::uint32_t* y, float* values);
    void sort_by_cell(std::span<const PageRef> pages, const std::vector<std::vector<CellRows>>& kept);
    std::size_t record_bytes() const { return 2 * sizeof(std::uint32_t) + lanes_ * sizeof(float); }

    const sampledb::Gathering& gathering_;
    const FilmGrid& grid_;
    const Channels& channels_;
    std::size_t lanes_;

    std::uint32_t* x_ = nullptr;
    std::uint32_t* y_ = nullptr;
    float* values_ = nullptr;
    std::atomic<std::uint32_t> record_count_ = 0;
    PixelRect cells_;
    std::vector<std::uint32_t> begin_;  // of each cell's segments, camera and light; one more at the end
    std::vector<Segment> segments_;

    std::mutex carry_mutex_;
    std::unordered_map<std::uint64_t, Carried> carried_;  // by run and index
    std::uint64_t carry_bytes_, carried_bytes_ = 0;
    DecodeCounts counts_;
};

}  // namespace latent::develop
