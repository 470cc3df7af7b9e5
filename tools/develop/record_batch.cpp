#include "tools/develop/record_batch.h"

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <utility>

#include "base/first_error.h"
#include "tools/develop/rows.h"

namespace latent::develop {

namespace {

constexpr int kSortedLevels = 16;               // within smaller cells than these, the records of a page are in any order
constexpr std::uint64_t kAlignment = 64;        // of arrays
constexpr std::size_t kPagesPerThread = 4;      // in work at once
constexpr std::uint64_t kReadAhead = 8 << 20;   // bytes of pages that are on their way from disk
constexpr std::uint64_t kReadAtOnce = 1 << 20;  // neighbours are announced together
constexpr int kRowBits = 16;                    // of the number of a row in its page
constexpr std::uint64_t kPageBytes = 96;        // of a page's reference and of what is kept of it while a batch is loaded

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
                       std::int64_t cell_y, sampledb::RecordClass record_class, std::vector<BatchSegments>& found) {
    found.clear();
    thread_local std::vector<BatchSegments> rest;  // of each batch
    rest.clear();
    for (const RecordBatch* batch : batches) {
        const std::span<const Segment> all = batch->segments(cell_x, cell_y, record_class);
        const auto first = std::ranges::lower_bound(all, range.begin, {}, &Segment::page);
        const auto last = std::ranges::lower_bound(first, all.end(), range.end, {}, &Segment::page);
        if (first != last) rest.push_back({batch, {first, last}});
    }
    const auto front = [](const BatchSegments& in_batch) { return in_batch.segments.front().page; };
    while (!rest.empty()) {
        const auto next = std::ranges::min_element(rest, {}, front);
        std::uint64_t end = range.end;  // where another batch goes on
        for (auto other = rest.begin(); other != rest.end(); ++other) {
            if (other != next) end = std::min(end, front(*other));
        }
        const auto stop = std::ranges::lower_bound(next->segments, end, {}, &Segment::page);
        found.push_back({next->batch, {next->segments.begin(), stop}});
        next->segments = {stop, next->segments.end()};
        if (next->segments.empty()) rest.erase(next);
    }
}

std::uint64_t Loader::bytes_at_most(const sampledb::PageInfo& page, const PixelRect& cells) const {
    const std::uint64_t pieces = pieces_at_most(page, cells);
    if (pieces == 0) return 0;
    return kPageBytes + page.record_count * record_bytes() + pieces * (sizeof(Segment) + sizeof(SlotRows));
}

std::uint64_t Loader::pieces_at_most(const sampledb::PageInfo& page, const PixelRect& cells) const {
    const PixelRect common = intersection(grid_.cells_of(page.node, page.part), cells);
    if (common.empty()) return 0;
    if (grid_.level() > kSortedLevels) return page.record_count;
    return std::min<std::uint64_t>(page.record_count, static_cast<std::uint64_t>(common.width() * common.height()));
}

std::uint64_t Loader::thread_bytes() const {
    if (!channels_.lens() || !channels_.lens()->moves_records()) return 0;
    return sampledb::max_page_records(run_set_.job()) *
           (sizeof(std::uint32_t) + 2 * sizeof(std::uint64_t) + stride_ * sizeof(float));
}

std::uint64_t Loader::index_bytes(const PixelRect& cells) {
    return (slot_count(cells) + 1) * sizeof(std::uint32_t) + 6 * kAlignment;  // arrays are rounded up
}

// A batch while its pages are decoded. Rows get their places as they come; only the index knows their order.
struct Loader::Filling {
    const PixelRect& cells;
    bool counting;
    float* values;
    std::uint32_t* x;
    std::uint32_t* y;
    SlotRows* pieces;
    std::atomic<std::uint32_t> row_count = 0, piece_count = 0;
};

Result<RecordBatch> Loader::load(std::span<const PageRef>& pages, const PixelRect& cells, std::span<std::byte>& memory,
                                 bool counting) {
    const std::uint64_t room = memory.size() - index_bytes(cells);
    std::uint64_t rows = 0, pieces = 0, bytes = 0;
    std::size_t taken = 0;
    for (; taken < pages.size(); ++taken) {
        const sampledb::PageInfo& page = pages[taken].info;
        const std::uint64_t more = bytes_at_most(page, cells);
        if (bytes + more > room) break;
        bytes += more;
        rows += page.record_count;
        pieces += pieces_at_most(page, cells);
    }
    assert(taken > 0 || pages.empty());

    // Values, x, y of as many rows as there may be; pieces at the end, out of the way of the segments that are made from them.
    std::span<std::byte> free = memory.first(memory.size() - pieces * sizeof(SlotRows) / kAlignment * kAlignment - kAlignment);
    auto* const last = reinterpret_cast<SlotRows*>(free.data() + free.size());
    Filling filling{cells,
                    counting,
                    take<float>(free, rows * stride_).data(),
                    take<std::uint32_t>(free, rows).data(),
                    take<std::uint32_t>(free, rows).data(),
                    last};
    std::vector<std::span<const SlotRows>> kept(taken);
    if (Status s = load_pages(pages.first(taken), filling, kept); !s) return s.error();

    // Pages may have had rows elsewhere: the columns close up.
    free = memory.first(static_cast<std::size_t>(reinterpret_cast<std::byte*>(last) - memory.data()));
    const std::uint32_t row_count = filling.row_count;
    const std::span<float> values = take<float>(free, row_count * stride_);
    const std::span<std::uint32_t> x = take<std::uint32_t>(free, row_count), y = take<std::uint32_t>(free, row_count);
    std::copy_n(filling.x, row_count, x.data());
    std::copy_n(filling.y, row_count, y.data());
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
            segments[begin[piece.slot + 1]++] = {pages[i].order, piece.first, piece.count};
        }
    }
    memory = memory.subspan(static_cast<std::size_t>(free.data() - memory.data()));
    pages = pages.subspan(taken);
    return RecordBatch{cells, {x.data(), y.data(), values.data()}, begin, segments};
}

// In parallel, begun in their order: so those that are read soon are announced to the system, and are on their way.
Status Loader::load_pages(std::span<const PageRef> pages, Filling& filling, std::vector<std::span<const SlotRows>>& kept) {
    FirstError error;
    std::size_t next = 0, announced = 0;
    std::uint64_t on_their_way = 0;
    const auto next_page = [&](tbb::flow_control& flow) -> std::size_t {
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

// Moves the rows of a page, whose cells are then in any order: `cells` are ranges of `moved.keys`. A radix sort, which keeps the
// order of rows within a cell.
void Loader::move_rows(sampledb::Page& page, const PixelRect& wanted, MovedRows& moved, std::vector<CellRows>& cells) const {
    cells.clear();
    channels_.lens()->move(page, moved.on_film);
    if (wanted.empty()) return;
    const auto x0 = static_cast<std::uint32_t>(wanted.x0), y0 = static_cast<std::uint32_t>(wanted.y0);
    const auto width = static_cast<std::uint64_t>(wanted.width()), height = static_cast<std::uint64_t>(wanted.height());
    moved.keys.resize(moved.on_film.size());
    std::size_t count = 0;
    for (const std::uint32_t row : moved.on_film) {
        const std::uint32_t x = grid_.cell_of(page.u[row]) - x0, y = grid_.cell_of(page.v[row]) - y0;
        if (x < width && y < height) moved.keys[count++] = (y * width + x) << kRowBits | row;
    }
    moved.keys.resize(count);
    constexpr int kDigitBits = 8;
    for (int shift = kRowBits; (width * height - 1) >> (shift - kRowBits) != 0; shift += kDigitBits) {
        const auto digit = [shift](std::uint64_t key) { return key >> shift & ((1 << kDigitBits) - 1); };
        std::array<std::uint32_t, (1 << kDigitBits) + 1> begin{};
        for (const std::uint64_t key : moved.keys) ++begin[digit(key) + 1];
        std::partial_sum(begin.begin(), begin.end(), begin.begin());
        moved.other_keys.resize(moved.keys.size());
        for (const std::uint64_t key : moved.keys) moved.other_keys[begin[digit(key)]++] = key;
        std::swap(moved.keys, moved.other_keys);
    }
    for (std::size_t first = 0, next = 0; first < moved.keys.size(); first = next) {
        const std::uint64_t cell = moved.keys[first] >> kRowBits;
        while (next < moved.keys.size() && moved.keys[next] >> kRowBits == cell) ++next;
        cells.push_back({x0 + static_cast<std::uint32_t>(cell % width), y0 + static_cast<std::uint32_t>(cell / width),
                         static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(next - first)});
    }
}

void Loader::copy_rows(const sampledb::Page& page, const CellRows& rows, const Filling& filling, std::uint32_t to) {
    place_rows(grid_.place_x(rows.cell_x), std::span(page.u).subspan(rows.first, rows.count), filling.x + to);
    place_rows(grid_.place_y(rows.cell_y), std::span(page.v).subspan(rows.first, rows.count), filling.y + to);
    count_not_finite(channels_.values(page, rows.first, std::size_t{rows.first} + rows.count, filling.values + to * stride_), page,
                     filling);
}

template <std::size_t kStride>
void Loader::copy_moved_rows(const sampledb::Page& page, const MovedRows& moved, const CellRows& rows, const Filling& filling,
                             std::uint32_t to) const {
    const std::size_t stride = kStride > 0 ? kStride : stride_;
    const FilmGrid::Place place_x = grid_.place_x(rows.cell_x), place_y = grid_.place_y(rows.cell_y);
    for (const std::uint64_t key : std::span(moved.keys).subspan(rows.first, rows.count)) {
        const std::size_t row = key & ((1 << kRowBits) - 1);
        filling.x[to] = place_x(page.u[row]), filling.y[to] = place_y(page.v[row]);
        std::copy_n(moved.values.data() + row * stride, stride, filling.values + to * stride);
        ++to;
    }
}

// Of the rows that are wanted; others count where they are.
std::uint64_t Loader::not_finite_of(const sampledb::Page& page, const MovedRows& moved) const {
    std::vector<float> values(stride_);
    std::uint64_t count = 0;
    for (const std::uint64_t key : moved.keys) {
        const std::size_t row = key & ((1 << kRowBits) - 1);
        count += channels_.values(page, row, row + 1, values.data());
    }
    return count;
}

void Loader::count_not_finite(std::uint64_t count, const sampledb::Page& page, const Filling& filling) {
    if (count == 0 || !filling.counting) return;
    (page.record_class == sampledb::RecordClass::kCamera ? counts_.camera_not_finite : counts_.light_not_finite) += count;
}

// Rows of zeros, which add nothing to any sum. Returns how many rows are left.
template <std::size_t kStride>
std::uint32_t Loader::drop_zeros(std::uint32_t count, std::uint32_t* x, std::uint32_t* y, float* values) const {
    const std::size_t stride = kStride > 0 ? kStride : stride_;
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float* const row = values + i * stride;
        if (std::all_of(row, row + stride, [](float value) { return value == 0; })) continue;
        x[kept] = x[i], y[kept] = y[i];
        if (kept < i) std::copy_n(row, stride, values + kept * stride);
        ++kept;
    }
    return kept;
}

Status Loader::load_page(const PageRef& ref, Filling& filling, std::span<const SlotRows>& kept) {
    Worker& worker = workers_.local();
    sampledb::Page& page = worker.page;
    std::vector<CellRows>& cells = worker.cells;
    if (Status s = run_set_.read_page(ref.run, ref.info, channels_.columns(), worker.decoder, page); !s) return s;
    ++counts_.pages;
    counts_.bytes += ref.info.stored_size;
    const LensWeights* const lens = channels_.lens() ? &*channels_.lens() : nullptr;
    const bool moves = lens != nullptr && lens->moves_records();
    if (moves) {
        move_rows(page, intersection(grid_.cells_of(ref.info.node, ref.info.part), filling.cells), worker.moved, cells);
        worker.moved.values.resize(page.count * stride_);
        if (channels_.values(page, 0, page.count, worker.moved.values.data()) > 0)
            count_not_finite(not_finite_of(page, worker.moved), page, filling);
    } else {
        find_cells(page, cells);
        std::erase_if(cells, [&](const CellRows& rows) { return !contains(filling.cells, rows.cell_x, rows.cell_y); });
    }
    if (cells.size() > pieces_at_most(ref.info, filling.cells)) {
        return Error{ErrorCode::kCorrupt, fmt::format("run {}: the records of a page are not in order", ref.run)};
    }
    std::uint32_t count = 0;
    for (const CellRows& rows : cells) count += rows.count;
    if (filling.counting)
        (page.record_class == sampledb::RecordClass::kCamera ? counts_.camera_records : counts_.light_records) += count;
    std::uint32_t to = filling.row_count.fetch_add(count);
    SlotRows* const pieces = filling.pieces + filling.piece_count.fetch_add(static_cast<std::uint32_t>(cells.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const CellRows& rows = cells[i];
        if (moves && stride_ == 4) {
            copy_moved_rows<4>(page, worker.moved, rows, filling, to);
        } else if (moves) {
            copy_moved_rows<0>(page, worker.moved, rows, filling, to);
        } else {
            copy_rows(page, rows, filling, to);
        }
        std::uint32_t left = rows.count;
        if (lens != nullptr && lens->leaves_records_out()) {
            float* const values = filling.values + to * stride_;
            left = stride_ == 4 ? drop_zeros<4>(rows.count, filling.x + to, filling.y + to, values)
                                : drop_zeros<0>(rows.count, filling.x + to, filling.y + to, values);
        }
        pieces[i] = {static_cast<std::uint32_t>(slot_of(filling.cells, rows.cell_x, rows.cell_y, page.record_class)), to, left};
        to += rows.count;
    }
    kept = {pieces, cells.size()};
    return {};
}

}  // namespace latent::develop
