#include "tools/develop/batch.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>

namespace latent::develop {

namespace {

constexpr std::uint64_t kSegmentBytes = 24;  // of one CellRows and one Segment

std::uint64_t key_of(const PageRef& page) { return std::uint64_t{page.run} << 32 | page.index; }

bool contains(const PixelRect& cells, std::int64_t x, std::int64_t y) {
    return x >= cells.x0 && x < cells.x1 && y >= cells.y0 && y < cells.y1;
}

std::uint64_t last_z_of(const FilmGrid& grid, const sampledb::FilmNode& node) {
    const PixelRect cells = grid.cells_of(node);
    return z_code(static_cast<std::uint32_t>(cells.x1 - 1), static_cast<std::uint32_t>(cells.y1 - 1));
}

}  // namespace

Batch::Batch(const sampledb::Gathering& gathering, const FilmGrid& grid, const Channels& channels, std::uint64_t carry_bytes)
    : gathering_(gathering), grid_(grid), channels_(channels), lanes_(channels.lanes()), carry_bytes_(carry_bytes) {}

std::uint64_t Batch::bytes_at_most(const sampledb::PageInfo& page, const PixelRect& cells) const {
    const PixelRect common = intersection(grid_.cells_of(page.node), cells);
    if (common.empty()) return 0;
    const auto cell_count = static_cast<std::uint64_t>(common.width() * common.height());
    return page.record_count * record_bytes() + std::min<std::uint64_t>(page.record_count, cell_count) * kSegmentBytes;
}

void Batch::clear() {
    record_count_ = 0;
    begin_.clear();
    segments_.clear();
}

Result<std::size_t> Batch::load(std::span<const PageRef> pages, std::span<std::byte> memory, const PixelRect& cells,
                                const PixelRect& needed, std::uint64_t z_end) {
    clear();
    cells_ = cells;
    const std::uint64_t room = memory.size();
    std::uint64_t records = 0, bytes = 0;
    std::size_t taken = 0;
    for (; taken < pages.size(); ++taken) {
        const std::uint64_t more = bytes_at_most(pages[taken].info, cells);
        if (taken > 0 && bytes + more > room) break;
        bytes += more;
        records += pages[taken].info.record_count;
    }
    assert(records * record_bytes() <= room);
    values_ = reinterpret_cast<float*>(memory.data());
    x_ = reinterpret_cast<std::uint32_t*>(values_ + records * lanes_);
    y_ = x_ + records;

    const Region region{cells, needed, z_end};
    std::vector<std::vector<CellRows>> kept(taken);
    std::mutex error_mutex;
    Status status;
    tbb::parallel_for(std::size_t{0}, taken, [&](std::size_t i) {
        Status s = load_page(pages[i], region, kept[i]);
        if (!s) {
            const std::lock_guard lock(error_mutex);
            if (status) status = std::move(s);
        }
    });
    if (!status) return status.error();
    sort_by_cell(pages.first(taken), kept);
    return taken;
}

// Runs of rows that lie in one cell. Pages are sorted along the Z curve, so there are few; small pages lie in one.
void Batch::find_cells(const sampledb::Page& page, std::vector<CellRows>& cells) const {
    cells.clear();
    if (page.count == 0) return;
    const auto n = static_cast<std::uint32_t>(page.count);
    CellRows current{grid_.cell_of(page.u[0]), grid_.cell_of(page.v[0]), 0, 0};
    std::uint32_t different_u = 0, different_v = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
        different_u |= page.u[i] ^ page.u[0];
        different_v |= page.v[i] ^ page.v[0];
    }
    if (grid_.cell_of(different_u | different_v) != 0) {
        for (std::uint32_t i = 1; i < n; ++i) {
            const std::uint32_t cell_x = grid_.cell_of(page.u[i]), cell_y = grid_.cell_of(page.v[i]);
            if (cell_x == current.cell_x && cell_y == current.cell_y) continue;
            current.count = i - current.first;
            cells.push_back(current);
            current = {cell_x, cell_y, i, 0};
        }
    }
    current.count = n - current.first;
    cells.push_back(current);
}

void Batch::copy_rows(const sampledb::Page& page, const CellRows& rows, std::uint32_t* x, std::uint32_t* y, float* values) {
    for (std::uint32_t i = 0; i < rows.count; ++i) {
        x[i] = grid_.place_x(page.u[rows.first + i]);
        y[i] = grid_.place_y(page.v[rows.first + i]);
    }
    const std::uint64_t not_finite = channels_.values(page, rows.first, std::size_t{rows.first} + rows.count, values);
    if (not_finite > 0) {
        const bool camera = page.record_class == sampledb::RecordClass::kCamera;
        (camera ? counts_.camera_not_finite : counts_.light_not_finite) += not_finite;
    }
}

Status Batch::load_page(const PageRef& ref, const Region& region, std::vector<CellRows>& kept) {
    Carried* carried = nullptr;
    {
        const std::lock_guard lock(carry_mutex_);
        if (const auto found = carried_.find(key_of(ref)); found != carried_.end()) carried = &found->second;
    }
    if (carried) {
        for (const CellRows& rows : carried->cells) {
            if (!contains(region.cells, rows.cell_x, rows.cell_y)) continue;
            const std::uint32_t to = record_count_.fetch_add(rows.count);
            std::copy_n(&carried->x[rows.first], rows.count, x_ + to);
            std::copy_n(&carried->y[rows.first], rows.count, y_ + to);
            std::copy_n(&carried->values[rows.first * lanes_], rows.count * lanes_, values_ + to * lanes_);
            kept.push_back({rows.cell_x, rows.cell_y, to, rows.count});
        }
        return {};
    }

    static thread_local sampledb::Page page;
    static thread_local std::vector<CellRows> cells;
    if (Status s = gathering_.read_page(ref.run, ref.info, channels_.columns(), page); !s) return s;
    ++counts_.pages;
    counts_.bytes += ref.info.stored_size;
    find_cells(page, cells);
    std::uint32_t inside = 0, later = 0;
    const auto is_later = [&](const CellRows& rows) {
        return contains(region.needed, rows.cell_x, rows.cell_y) && z_code(rows.cell_x, rows.cell_y) >= region.z_end;
    };
    for (const CellRows& rows : cells) {
        if (contains(region.cells, rows.cell_x, rows.cell_y)) inside += rows.count;
    }
    std::uint32_t to = record_count_.fetch_add(inside);
    for (const CellRows& rows : cells) {
        if (!contains(region.cells, rows.cell_x, rows.cell_y)) {
            if (is_later(rows)) later += rows.count;
            continue;
        }
        copy_rows(page, rows, x_ + to, y_ + to, values_ + to * lanes_);
        kept.push_back({rows.cell_x, rows.cell_y, to, rows.count});
        to += rows.count;
    }
    if (later == 0) return {};

    const std::uint64_t bytes = later * (record_bytes() + kSegmentBytes) + sizeof(Carried) + 64;
    {
        const std::lock_guard lock(carry_mutex_);
        if (carried_bytes_ + bytes > carry_bytes_) return {};
        carried_bytes_ += bytes;
    }
    Carried rest{{},
                 std::vector<std::uint32_t>(later),
                 std::vector<std::uint32_t>(later),
                 std::vector<float>(later * lanes_),
                 last_z_of(grid_, ref.info.node),
                 bytes};
    to = 0;
    for (const CellRows& rows : cells) {
        if (!is_later(rows)) continue;
        copy_rows(page, rows, &rest.x[to], &rest.y[to], &rest.values[to * lanes_]);
        rest.cells.push_back({rows.cell_x, rows.cell_y, to, rows.count});
        to += rows.count;
    }
    const std::lock_guard lock(carry_mutex_);
    carried_.emplace(key_of(ref), std::move(rest));
    return {};
}

void Batch::sort_by_cell(std::span<const PageRef> pages, const std::vector<std::vector<CellRows>>& kept) {
    const auto slot = [&](const CellRows& rows, std::size_t page) {
        const std::size_t cell = (rows.cell_y - cells_.y0) * cells_.width() + (rows.cell_x - cells_.x0);
        return 2 * cell + (pages[page].info.record_class == sampledb::RecordClass::kLight ? 1 : 0);
    };
    const std::size_t slots = 2 * static_cast<std::size_t>(cells_.width() * cells_.height());
    begin_.assign(slots + 1, 0);
    std::size_t count = 0;
    for (std::size_t p = 0; p < kept.size(); ++p) {
        for (const CellRows& rows : kept[p]) ++begin_[slot(rows, p) + 1];
        count += kept[p].size();
    }
    for (std::size_t s = 0; s < slots; ++s) begin_[s + 1] += begin_[s];
    segments_.resize(count);
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t p = 0; p < kept.size(); ++p) {
        for (const CellRows& rows : kept[p]) segments_[next[slot(rows, p)]++] = {rows.first, rows.count};
    }
}

std::span<const Segment> Batch::segments(std::int64_t cell_x, std::int64_t cell_y, sampledb::RecordClass record_class) const {
    if (begin_.empty()) return {};
    const std::size_t cell = (cell_y - cells_.y0) * cells_.width() + (cell_x - cells_.x0);
    const std::size_t slot = 2 * cell + (record_class == sampledb::RecordClass::kLight ? 1 : 0);
    return std::span(segments_).subspan(begin_[slot], begin_[slot + 1] - begin_[slot]);
}

void Batch::forget_before(std::uint64_t z_end) {
    for (auto it = carried_.begin(); it != carried_.end();) {
        if (it->second.last_z < z_end) {
            carried_bytes_ -= it->second.bytes;
            it = carried_.erase(it);
        } else {
            ++it;
        }
    }
}

}  // namespace latent::develop
