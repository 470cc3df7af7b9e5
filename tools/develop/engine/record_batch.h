// tools/develop/engine/record_batch.h: decoded records of many pages, sorted into cells. docs/developing.md, "Record batches".
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/read/run_set.h"
#include "tools/develop/channels/channels.h"
#include "tools/develop/film/film_grid.h"
#include "tools/develop/kernel/scatter.h"
#include "tools/develop/kernel/splat.h"

namespace latent::develop {

// Where a page comes in the order in which records are added up: by run, then along the run's Z order.
inline std::uint64_t page_order(std::size_t run, std::uint32_t index) { return std::uint64_t{run} << 32 | index; }

struct PageRef {
    std::uint32_t run;
    std::uint64_t order;
    sampledb::PageInfo info;
};

// Records that lie in `cells`. They and the arrays lie in memory that the loader was lent.
struct RecordBatch {
    PixelRect cells;
    std::span<const std::uint32_t> begin;  // where each cell's segments begin, camera and light; one more at the end
    std::span<const Segment> all_segments;

    // Those of one cell, ascending by page.
    std::span<const Segment> segments(std::int64_t cell_x, std::int64_t cell_y, sampledb::RecordClass record_class) const;
};

// Pages by their order, begin .. end-1.
struct PageRange {
    std::uint64_t begin = 0, end = ~std::uint64_t{0};
};
// The segments of a cell and class, of pages in `range`, that several batches have: in the order of their pages.
void segments_in_order(std::span<const RecordBatch* const> batches, const PageRange& range, std::int64_t cell_x,
                       std::int64_t cell_y, sampledb::RecordClass record_class, std::vector<std::span<const Segment>>& found);

struct DecodeCounts {
    std::atomic<std::uint64_t> pages = 0, bytes = 0;  // decoded, repeats included
    std::atomic<std::uint64_t> segments = 0;
    std::atomic<std::uint64_t> camera_records = 0, light_records = 0;  // taken into batches
    std::atomic<std::uint64_t> camera_not_finite = 0, light_not_finite = 0;
};

// Where the records of a page go: cells, and the smallest node of the film that holds these.
struct PageReach {
    sampledb::FilmNode node;
    PixelRect cells;
};

// Decodes pages, in parallel, into batches.
class Loader {
 public:
    Loader(const sampledb::RunSet& run_set, const FilmGrid& grid, const Channels& channels, const Stopped& stopped)
        : run_set_(run_set),
          grid_(grid),
          channels_(channels),
          stopped_(stopped),
          stride_(static_cast<std::size_t>(channels.stride())) {}

    PageReach reach(const sampledb::PageInfo& page) const;
    // Bytes that a page's records in `cells` need at most, and that any batch of `cells` needs beside its pages.
    std::uint64_t bytes_at_most(const sampledb::PageInfo& page, const PixelRect& cells) const;
    static std::uint64_t index_bytes(const PixelRect& cells);
    // About how many segments a page makes in `cells`, if its records lie anywhere in its part of the film.
    double expected_segments(const sampledb::PageInfo& page, const PixelRect& cells) const;
    static std::uint64_t segment_bytes() { return sizeof(Segment) + sizeof(SlotRows); }  // beside its records
    // Bytes that each thread needs beside a decoded page.
    std::uint64_t thread_bytes() const;

    // Takes as many pages as fit off the front of `pages` (there must be room for one), and what their records need off the front
    // of `memory`. `counting`: their records have not been counted before.
    Result<RecordBatch> load(std::span<const PageRef>& pages, const PixelRect& cells, std::span<std::byte>& memory, bool counting);

    const DecodeCounts& counts() const { return counts_; }

 private:
    struct CellRows {  // rows first .. first + count - 1 of a page lie in one cell
        std::uint32_t cell_x, cell_y, first, count;
    };
    struct SlotRows {  // rows of the batch, from that number on, and the place of their cell and class in its index
        std::uint32_t slot, first, count, room;
    };
    struct Filling;
    // Where the rows of a page go whose records a lens has moved.
    struct MovedRows {
        PixelRect wanted;                  // cells, numbered row by row
        std::vector<std::uint32_t> cell;   // each row's; that behind the last for rows elsewhere
        std::vector<std::uint32_t> count;  // rows in each cell
        std::vector<CellSpace> spaces;     // one for each cell, and one for rows elsewhere
        std::vector<std::byte> left_out;   // room for these
        std::vector<float> values;         // those of a few rows
        std::uint32_t kept_of(std::int64_t x, std::int64_t y) const {
            return spaces[static_cast<std::size_t>((y - wanted.y0) * wanted.width() + x - wanted.x0)].kept;
        }
        std::uint32_t elsewhere() const { return static_cast<std::uint32_t>(wanted.width() * wanted.height()); }
    };
    struct Worker {  // what a thread keeps from page to page
        sampledb::PageDecoder decoder;
        sampledb::Page page;
        std::vector<CellRows> cells;
        MovedRows moved;
    };

    bool moves_records() const { return channels_.lens() && channels_.lens()->moves_records(); }
    std::uint64_t pieces_at_most(const sampledb::PageInfo& page, const PixelRect& cells) const;
    Status load_pages(std::span<const PageRef> pages, Filling& filling, std::vector<std::span<const SlotRows>>& kept);
    Status load_page(const PageRef& page, Filling& filling, std::span<const SlotRows>& kept);
    void find_cells(const sampledb::Page& page, std::vector<CellRows>& cells) const;
    void move_rows(sampledb::Page& page, MovedRows& moved, std::vector<CellRows>& cells) const;
    std::uint64_t not_finite_of(const sampledb::Page& page, const MovedRows& moved, std::size_t begin, std::size_t end) const;
    void count_not_finite(std::uint64_t count, const sampledb::Page& page, const Filling& filling);
    std::uint64_t sort_moved_rows(const sampledb::Page& page, MovedRows& moved, std::byte* memory) const;

    const sampledb::RunSet& run_set_;
    const FilmGrid& grid_;
    const Channels& channels_;
    const Stopped& stopped_;
    std::size_t stride_;
    DecodeCounts counts_;
    tbb::enumerable_thread_specific<Worker> workers_;
};

}  // namespace latent::develop
