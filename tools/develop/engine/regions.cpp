#include "tools/develop/engine/regions.h"

#include <algorithm>

#include "sampledb/data/z_order.h"

namespace latent::develop {

namespace {

using sampledb::FilmNode;

constexpr int kCountedLevels = 8;             // nodes are counted one by one down to this level; deeper ones share their ancestor's
constexpr std::uint64_t kMinBatch = 8 << 20;  // bytes

// A node is as large as memory allows only where pages are that large: small ones stay in the caches and touch less memory. But no
// smaller than to read kMinRead of a run at once, on average.
constexpr std::uint64_t kComfortable = 32 << 20;
constexpr std::uint64_t kMinRead = 256 << 10;

// The share of the four children of a node (its cells) that some of its cells lie in; a single cell is not split.
double share_of_children(const PixelRect& node, const PixelRect& cells) {
    if (node.width() == 1) return 1;
    const std::int64_t x = (node.x0 + node.x1) / 2, y = (node.y0 + node.y1) / 2;
    return (cells.x0 < x && cells.x1 > x ? 1 : 0.5) * (cells.y0 < y && cells.y1 > y ? 1 : 0.5);
}

}  // namespace

FilmNode child(const FilmNode& node, int i) {
    return {static_cast<std::uint8_t>(node.level + 1), 2 * node.x + (i & 1), 2 * node.y + (i >> 1)};
}

ZRange z_range(const FilmGrid& grid, const FilmNode& node) {
    const PixelRect cells = grid.cells_of(node);
    return {sampledb::z_code(static_cast<std::uint32_t>(cells.x0), static_cast<std::uint32_t>(cells.y0)),
            sampledb::z_code(static_cast<std::uint32_t>(cells.x1 - 1), static_cast<std::uint32_t>(cells.y1 - 1)) + 1};
}

Plan::Plan(const FilmGrid& grid, const PixelRect& needed, const CellBytes& cell_bytes, std::uint64_t runs)
    : grid_(&grid), needed_(needed), cell_bytes_(cell_bytes), runs_(runs), min_batch_(kMinBatch) {
    const int deepest = std::min(grid.level(), kCountedLevels);
    for (int level = 0; level <= deepest; ++level) inside_.emplace_back(std::size_t{1} << (2 * level), 0);
}

Result<Plan> Plan::make(const sampledb::RunSet& run_set, const FilmGrid& grid, const PixelRect& needed, Classes classes,
                        const Loader& loader, const CellBytes& cell_bytes) {
    Plan plan(grid, needed, cell_bytes, run_set.runs().size());
    double reached = 0;  // bytes
    for (std::size_t run = 0; run < run_set.runs().size(); ++run) {
        const auto pages = run_set.pages(run);
        if (!pages) return pages.error();
        for (const sampledb::PageInfo& page : **pages) {
            const std::uint64_t bytes = classes.has(page.record_class) ? loader.bytes_at_most(page, needed) : 0;
            if (bytes == 0) continue;
            plan.min_batch_ = std::max(plan.min_batch_, bytes + Loader::index_bytes({0, 0, 1, 1}));
            ++plan.pages_;
            plan.stored_bytes_ += page.stored_size;
            plan.segments_ += loader.expected_segments(page, needed);
            const auto [node, cells] = loader.reach(page);
            reached += static_cast<double>(bytes) * share_of_children(grid.cells_of(node), cells);
            const int level = std::min<int>(node.level, static_cast<int>(plan.inside_.size()) - 1);
            std::uint64_t z = sampledb::z_code(node.x, node.y) >> (2 * (node.level - level));
            for (int above = level; above >= 0; --above, z >>= 2) plan.inside_[above][z] += bytes;
        }
    }
    if (const std::uint64_t all = plan.inside({}); all > 0) plan.reach_ = reached / static_cast<double>(all);
    return plan;
}

std::uint64_t Plan::inside(const FilmNode& node) const {
    const int level = std::min<int>(node.level, static_cast<int>(inside_.size()) - 1);
    return inside_[level][sampledb::z_code(node.x, node.y) >> (2 * (node.level - level))];
}

std::uint64_t Plan::own(const FilmNode& node) const {
    if (node.level + 1 >= static_cast<int>(inside_.size())) return 0;  // counted as inside the children too
    std::uint64_t bytes = inside(node);
    for (int i = 0; i < 4; ++i) bytes -= inside(child(node, i));
    return bytes;
}

std::uint64_t Plan::window_bytes(const PixelRect& cells) const {
    const PixelRect inner = grid_->inner_cells(cells);
    const std::int64_t all = cells.width() * cells.height(), inside = inner.empty() ? 0 : inner.width() * inner.height();
    return static_cast<std::uint64_t>(all) * cell_bytes_.window + static_cast<std::uint64_t>(all - inside) * cell_bytes_.positive;
}

Way Plan::way(const FilmNode& node, std::uint64_t room, std::uint64_t missed) const {
    const PixelRect its_cells = cells(node);
    const std::uint64_t index = Loader::index_bytes(its_cells);
    const std::uint64_t records = inside(node) + missed + index;
    const std::uint64_t windows = window_bytes(its_cells) + index;
    const bool resident = records <= std::min(std::max(room / 8 * 5, min_batch_), room - cell_bytes_.window);
    const bool streaming = windows <= std::min(room / 4 * 3, room - min_batch_);
    const bool splits_well = std::min(records, windows) > kComfortable && own(node) <= records / 4 && missed <= records / 64 &&
                             records / 4 >= runs_ * kMinRead;
    if (node.level < grid_->level() && (splits_well || (!resident && !streaming))) return Way::kSplit;
    return resident ? Way::kResident : Way::kStreaming;
}

bool Plan::holds(const FilmNode& node, std::uint64_t room, std::uint64_t missed) const {
    return best_split(node, room, {missed, missed}).holds;
}

Plan::Split Plan::best_split(const FilmNode& node, std::uint64_t room, const Missed& missed) const {
    const auto children = [&](std::uint64_t its_room, const Missed& its_missed) {
        std::uint64_t bytes = 0;
        for (int i = 0; i < 4; ++i) bytes += decoded(child(node, i), its_room, its_missed);
        return bytes;
    };
    const std::uint64_t bytes = own(node), takes = bytes + Loader::index_bytes(cells(node));
    const Missed more{missed.all + bytes, missed.decoded + static_cast<std::uint64_t>(reach_ * static_cast<double>(bytes))};
    if (bytes == 0 || takes + min_room() > room) return {false, children(room, more)};
    const Split with{true, bytes + children(room - takes, missed)};
    if (bytes <= inside(node) / 64) return with;  // they take next to nothing
    const Split without{false, children(room, more)};
    return with.decoded <= without.decoded ? with : without;
}

double Plan::decode_factor(std::uint64_t room) const {
    const std::uint64_t once = inside({});
    return once == 0 ? 1 : static_cast<double>(decoded({}, room, {})) / static_cast<double>(once);
}

std::uint64_t Plan::decoded(const FilmNode& node, std::uint64_t room, const Missed& missed) const {
    if (cells(node).empty()) return 0;
    return way(node, room, missed.all) == Way::kSplit ? best_split(node, room, missed).decoded : inside(node) + missed.decoded;
}

}  // namespace latent::develop
