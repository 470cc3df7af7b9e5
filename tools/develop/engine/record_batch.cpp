#include "tools/develop/engine/record_batch.h"

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/first_error.h"
#include "tools/develop/channels/rows.h"

namespace latent::develop {

namespace {

constexpr int kSortedLevels = 16;               // within smaller cells than these, the records of a page are in any order
constexpr std::uint64_t kAlignment = 64;        // bytes, of each array
constexpr std::size_t kAtOnce = 512;            // rows whose values stay in the nearest cache
constexpr std::size_t kPagesPerThread = 4;      // in work at once
constexpr std::uint64_t kReadAhead = 8 << 20;   // bytes of pages that are on their way from disk
constexpr std::uint64_t kReadAtOnce = 1 << 20;  // neighbours are announced together
constexpr std::uint64_t kPageBytes = 96;        // a page's reference, and what is kept of it while a batch is loaded

// Takes an array off the front of memory.
template <class T>
std::span<T> take(std::span<std::byte>& memory, std::size_t count) {
    const std::size_t bytes = (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
    assert(bytes <= memory.size());
    T* const array = reinterpret_cast<T*>(memory.data());
    memory = memory.subspan(bytes);
    return {array, count};
}

bool contains(const PixelRect& cells, std::int64_t x, std::int64_t y) {
    return x >= cells.x0 && x < cells.x1 && y >= cells.y0 && y < cells.y1;
}

// Where a cell's camera segments, or its light segments, stand in the index of a batch.
std::size_t slot_of(const PixelRect& cells, std::int64_t x, std::int64_t y, sampledb::RecordClass record_class) {
    return 2 * static_cast<std::size_t>((y - cells.y0) * cells.width() + (x - cells.x0)) +
           (record_class == sampledb::RecordClass::kLight ? 1 : 0);
}
std::size_t slot_count(const PixelRect& cells) { return 2 * static_cast<std::size_t>(cells.width() * cells.height()); }

}  // namespace

std::span<const Segment> RecordBatch::segments(std::int64_t cell_x, std::int64_t cell_y, sampledb::RecordClass record_class) const {
    const std::size_t slot = slot_of(cells, cell_x, cell_y, record_class);
    return all_segments.subspan(begin[slot], begin[slot + 1] - begin[slot]);
}

void segments_in_order(std::span<const RecordBatch* const> batches, const PageRange& range, std::int64_t cell_x,
                       std::int64_t cell_y, sampledb::RecordClass record_class, std::vector<std::span<const Segment>>& found) {
    found.clear();
    thread_local std::vector<std::span<const Segment>> rest;  // what is left of each batch
    rest.clear();
    for (const RecordBatch* batch : batches) {
        const std::span<const Segment> all = batch->segments(cell_x, cell_y, record_class);
        const auto first = std::ranges::lower_bound(all, range.begin, {}, &Segment::page);
        const auto last = std::ranges::lower_bound(first, all.end(), range.end, {}, &Segment::page);
        if (first != last) rest.emplace_back(first, last);
    }
    const auto front = [](std::span<const Segment> in_batch) { return in_batch.front().page; };
    while (!rest.empty()) {
        const auto next = std::ranges::min_element(rest, {}, front);
        std::uint64_t end = range.end;  // where another batch goes on
        for (auto other = rest.begin(); other != rest.end(); ++other) {
            if (other != next) end = std::min(end, front(*other));
        }
        const auto stop = std::ranges::lower_bound(*next, end, {}, &Segment::page);
        found.emplace_back(next->begin(), stop);
        *next = {stop, next->end()};
        if (next->empty()) rest.erase(next);
    }
}

PageReach Loader::reach(const sampledb::PageInfo& page) const {
    const PositionRect positions = positions_of(page);
    const PixelRect cells = grid_.cells_of(moves_records() ? channels_.lens()->moved_from(positions) : positions);
    return {grid_.node_about(cells), cells};
}

std::uint64_t Loader::bytes_at_most(const sampledb::PageInfo& page, const PixelRect& cells) const {
    const std::uint64_t pieces = pieces_at_most(page, cells);
    if (pieces == 0) return 0;
    const PixelRect sorted = moves_records() ? intersection(reach(page).cells, cells) : PixelRect{};
    return kPageBytes + SegmentColumns::bytes(page.record_count, stride_) + pieces * segment_bytes() +
           static_cast<std::uint64_t>(sorted.width() * sorted.height()) * (sizeof(std::uint32_t) + sizeof(SegmentColumns));
}

std::uint64_t Loader::pieces_at_most(const sampledb::PageInfo& page, const PixelRect& cells) const {
    const PixelRect common = intersection(reach(page).cells, cells);
    if (common.empty()) return 0;
    if (grid_.level() > kSortedLevels) return page.record_count;
    return std::min<std::uint64_t>(page.record_count, static_cast<std::uint64_t>(common.width() * common.height()));
}

double Loader::expected_segments(const sampledb::PageInfo& page, const PixelRect& cells) const {
    const auto area = [](const PixelRect& r) { return static_cast<double>(r.width()) * static_cast<double>(r.height()); };
    const PixelRect all = reach(page).cells, common = intersection(all, cells);
    if (common.empty()) return 0;
    return area(common) * -std::expm1(-static_cast<double>(page.record_count) / area(all));
}

std::uint64_t Loader::thread_bytes() const {
    if (!moves_records()) return 0;
    return sampledb::max_page_records(run_set_.job()) * sizeof(std::uint32_t);
}

std::uint64_t Loader::index_bytes(const PixelRect& cells) {
    return (slot_count(cells) + 1) * sizeof(std::uint32_t) + 6 * kAlignment;  // arrays are rounded up
}

// A batch while its pages are decoded. Rows get their places as they come; only the index knows their order.
struct Loader::Filling {
    const PixelRect& cells;
    bool counting;
    std::byte* rows;
    SlotRows* pieces;
    std::atomic<std::uint32_t> row_count = 0, piece_count = 0;
};

Result<RecordBatch> Loader::load(std::span<const PageRef>& pages, const PixelRect& cells, std::span<std::byte>& memory,
                                 bool counting) {
    const std::uint64_t room = memory.size() - index_bytes(cells);
    std::uint64_t pieces = 0, bytes = 0;
    std::size_t taken = 0;
    for (; taken < pages.size(); ++taken) {
        const sampledb::PageInfo& page = pages[taken].info;
        const std::uint64_t more = bytes_at_most(page, cells);
        if (bytes + more > room) break;
        bytes += more;
        pieces += pieces_at_most(page, cells);
    }
    assert(taken > 0 || pages.empty());

    // Rows come first; pieces lie at the end, out of the way of the segments that are made from them.
    std::span<std::byte> free = memory.first(memory.size() - pieces * sizeof(SlotRows) / kAlignment * kAlignment - kAlignment);
    Filling filling{cells, counting, free.data(), reinterpret_cast<SlotRows*>(free.data() + free.size())};
    std::vector<std::span<const SlotRows>> kept(taken);
    if (Status s = load_pages(pages.first(taken), filling, kept); !s) return s.error();

    take<std::byte>(free, SegmentColumns::bytes(filling.row_count, stride_));  // pages may have had rows elsewhere
    const std::span<std::uint32_t> begin = take<std::uint32_t>(free, slot_count(cells) + 1);
    const std::span<Segment> segments = take<Segment>(free, filling.piece_count);

    // Counting sort by slot: begin[s + 1] is where the next segment of slot s goes.
    std::ranges::fill(begin, 0);
    for (const std::span<const SlotRows> page : kept) {
        for (const SlotRows& piece : page) {
            if (piece.slot + 2 < begin.size()) ++begin[piece.slot + 2];
        }
    }
    for (std::size_t s = 1; s < begin.size(); ++s) begin[s] += begin[s - 1];
    for (std::size_t i = 0; i < taken; ++i) {
        for (const SlotRows& piece : kept[i]) {
            segments[begin[piece.slot + 1]++] = {pages[i].order, filling.rows + SegmentColumns::bytes(piece.first, stride_),
                                                 piece.count, piece.room};
        }
    }
    memory = memory.subspan(static_cast<std::size_t>(free.data() - memory.data()));
    pages = pages.subspan(taken);
    return RecordBatch{cells, begin, segments};
}

// In parallel, begun in their order: so those that are read soon are announced to the system, and are on their way.
Status Loader::load_pages(std::span<const PageRef> pages, Filling& filling, std::vector<std::span<const SlotRows>>& kept) {
    FirstError error;
    std::size_t next = 0, announced = 0;
    std::uint64_t on_their_way = 0;
    const auto next_page = [&](tbb::flow_control& flow) -> std::size_t {
        if (is_true(stopped_)) error.set(given_up());
        if (next == pages.size() || error) {
            flow.stop();
            return 0;
        }
        while (announced < pages.size() && (on_their_way < kReadAhead || announced == next)) {
            const PageRef& first = pages[announced];
            std::uint64_t end = first.info.offset, bytes = 0;
            for (; announced < pages.size() && pages[announced].run == first.run && pages[announced].info.offset == end &&
                   bytes < kReadAtOnce;
                 ++announced) {
                bytes += pages[announced].info.stored_size;
                end += pages[announced].info.stored_size;
            }
            run_set_.will_read(first.run, first.info, pages[announced - 1].info);
            on_their_way += bytes;
        }
        on_their_way -= pages[next].info.stored_size;
        return next++;
    };
    const auto load = [&](std::size_t i) { error.keep(load_page(pages[i], filling, kept[i])); };
    tbb::parallel_pipeline(kPagesPerThread * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()),
                           tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, next_page) &
                               tbb::make_filter<std::size_t, void>(tbb::filter_mode::parallel, load));
    return error.status();
}

// Runs of rows that lie in one cell. Pages are sorted along the Z curve, so there are few; small pages lie in one.
void Loader::find_cells(const sampledb::Page& page, std::vector<CellRows>& cells) const {
    cells.clear();
    if (page.count == 0) return;
    constexpr std::size_t kBlock = 256;
    const std::size_t n = page.count;
    CellRows current{grid_.cell_of(page.u[0]), grid_.cell_of(page.v[0]), 0, 0};
    for (std::size_t begin = 1; begin < n; begin += kBlock) {
        const std::size_t end = std::min(begin + kBlock, n);
        std::uint32_t different = 0;  // bits in which neighbours differ; nearly always those within a cell
        for (std::size_t i = begin; i < end; ++i) different |= (page.u[i] ^ page.u[i - 1]) | (page.v[i] ^ page.v[i - 1]);
        if (grid_.cell_of(different) == 0) continue;
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t cell_x = grid_.cell_of(page.u[i]), cell_y = grid_.cell_of(page.v[i]);
            if (cell_x == current.cell_x && cell_y == current.cell_y) continue;
            current.count = static_cast<std::uint32_t>(i) - current.first;
            cells.push_back(current);
            current = {cell_x, cell_y, static_cast<std::uint32_t>(i), 0};
        }
    }
    current.count = static_cast<std::uint32_t>(n) - current.first;
    cells.push_back(current);
}

// Moves the rows of a page, and counts those of each cell: rows come in any order of cells. The positions of rows elsewhere mean
// nothing.
void Loader::move_rows(sampledb::Page& page, MovedRows& moved, std::vector<CellRows>& cells) const {
    cells.clear();
    const std::uint32_t elsewhere = moved.elsewhere();
    moved.cell.resize(page.count);
    moved.count.assign(elsewhere + 1, 0);
    channels_.lens()->move(page, grid_.level(), moved.wanted, moved.cell);
    const std::uint32_t* const its_cell = moved.cell.data();
    std::uint32_t* const count = moved.count.data();
    for (std::size_t row = 0; row < page.count; ++row) ++count[its_cell[row]];
    const auto its_x = [&](std::uint32_t cell) {
        return static_cast<std::uint32_t>(moved.wanted.x0 + cell % moved.wanted.width());
    };
    const auto its_y = [&](std::uint32_t cell) {
        return static_cast<std::uint32_t>(moved.wanted.y0 + cell / moved.wanted.width());
    };
    std::uint32_t end = 0;
    for (std::uint32_t cell = 0; cell < elsewhere; ++cell) {
        if (count[cell] == 0) continue;
        cells.push_back({its_x(cell), its_y(cell), end, count[cell]});
        end += count[cell];
    }
}

// A counting sort, which keeps the order of rows within a cell, without rows of zeros if there are many. x and y are positions on
// the film. Returns how many of the rows have values that are not finite.
std::uint64_t Loader::sort_moved_rows(const sampledb::Page& page, MovedRows& moved, std::byte* memory) const {
    moved.spaces.clear();
    for (std::uint32_t cell = 0; cell < moved.elsewhere(); ++cell) {
        moved.spaces.push_back({SegmentColumns::at(memory, moved.count[cell]), 0, moved.count[cell]});
        memory += SegmentColumns::bytes(moved.count[cell], stride_);
    }
    moved.left_out.resize(SegmentColumns::bytes(kAtOnce, stride_));
    moved.spaces.push_back({SegmentColumns::at(moved.left_out.data(), kAtOnce), 0, kAtOnce});
    moved.values.resize(kAtOnce * stride_);
    std::uint64_t not_finite = 0;
    for (std::size_t begin = 0; begin < page.count; begin += kAtOnce) {
        const std::size_t end = std::min(begin + kAtOnce, page.count);
        if (channels_.values(page, begin, end, moved.values.data()) > 0) not_finite += not_finite_of(page, moved, begin, end);
        const std::span<const std::uint32_t> cells = std::span(moved.cell).subspan(begin, end - begin);
        scatter({cells, &page.u[begin], &page.v[begin], moved.values.data(), stride_}, channels_.lens()->leaves_records_out(),
                moved.spaces);
    }
    return not_finite;
}

// Counts the wanted rows; others count where they are.
std::uint64_t Loader::not_finite_of(const sampledb::Page& page, const MovedRows& moved, std::size_t begin, std::size_t end) const {
    std::vector<float> values(stride_);
    std::uint64_t count = 0;
    for (std::size_t row = begin; row < end; ++row) {
        if (moved.cell[row] != moved.elsewhere()) count += channels_.values(page, row, row + 1, values.data());
    }
    return count;
}

void Loader::count_not_finite(std::uint64_t count, const sampledb::Page& page, const Filling& filling) {
    if (count == 0 || !filling.counting) return;
    (page.record_class == sampledb::RecordClass::kCamera ? counts_.camera_not_finite : counts_.light_not_finite) += count;
}

Status Loader::load_page(const PageRef& ref, Filling& filling, std::span<const SlotRows>& kept) {
    Worker& worker = workers_.local();
    sampledb::Page& page = worker.page;
    std::vector<CellRows>& cells = worker.cells;
    if (Status s = run_set_.read_page(ref.run, ref.info, channels_.columns(), worker.decoder, page); !s) return s;
    ++counts_.pages;
    counts_.bytes += ref.info.stored_size;
    const LensWeights* const lens = channels_.lens() ? &*channels_.lens() : nullptr;
    if (moves_records()) {
        worker.moved.wanted = intersection(reach(ref.info).cells, filling.cells);
        move_rows(page, worker.moved, cells);
    } else {
        find_cells(page, cells);
        std::erase_if(cells, [&](const CellRows& rows) { return !contains(filling.cells, rows.cell_x, rows.cell_y); });
    }
    if (cells.size() > pieces_at_most(ref.info, filling.cells)) {
        return Error{ErrorCode::kCorrupt, fmt::format("run {}: the records of a page are not in order", ref.run)};
    }
    counts_.segments += cells.size();
    std::uint32_t count = 0;
    for (const CellRows& rows : cells) count += rows.count;
    if (filling.counting)
        (page.record_class == sampledb::RecordClass::kCamera ? counts_.camera_records : counts_.light_records) += count;
    std::uint32_t to = filling.row_count.fetch_add(count);
    SlotRows* const pieces = filling.pieces + filling.piece_count.fetch_add(static_cast<std::uint32_t>(cells.size()));
    if (moves_records())
        count_not_finite(sort_moved_rows(page, worker.moved, filling.rows + SegmentColumns::bytes(to, stride_)), page, filling);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const CellRows& rows = cells[i];
        std::byte* const memory = filling.rows + SegmentColumns::bytes(to, stride_);
        const SegmentColumns columns = SegmentColumns::at(memory, rows.count);
        std::uint32_t left = moves_records() ? worker.moved.kept_of(rows.cell_x, rows.cell_y) : rows.count;
        const auto place = [&](const FilmGrid::Place& of, const std::vector<std::uint32_t>& positions, std::uint32_t* places) {
            const std::uint32_t* const from = moves_records() ? places : positions.data() + rows.first;
            place_rows(of, {from, left}, places);
        };
        place(grid_.place_x(rows.cell_x), page.u, columns.x);
        place(grid_.place_y(rows.cell_y), page.v, columns.y);
        if (!moves_records()) {
            const std::size_t first = rows.first;
            const std::uint64_t not_finite = channels_.values(page, first, first + rows.count, columns.values);
            count_not_finite(not_finite, page, filling);
            if (lens != nullptr && lens->leaves_records_out()) left = drop_zeros(columns, rows.count, stride_);
        }
        pieces[i] = {static_cast<std::uint32_t>(slot_of(filling.cells, rows.cell_x, rows.cell_y, page.record_class)), to, left,
                     rows.count};
        to += rows.count;
    }
    kept = {pieces, cells.size()};
    return {};
}

}  // namespace latent::develop
