#include "tools/develop/regions.h"

#include <algorithm>

namespace latent::develop {

namespace {

using sampledb::FilmNode;

constexpr int kCountedLevels = 8;  // bytes of records are counted for nodes down to this level; deeper ones share their ancestor's

// Upper bounds of the bytes that the records in a node take.
class RecordBytes {
 public:
    explicit RecordBytes(int deepest) : own_(deepest + 1) {
        for (int level = 0; level <= deepest; ++level) own_[level].assign(std::size_t{1} << (2 * level), 0);
    }
    void add(const FilmNode& node, std::uint64_t bytes) {
        const int level = std::min<int>(node.level, deepest());
        own_[level][slot(level, node)] += bytes;
    }
    // own_[level] of a node: the pages of exactly that node; after `sum_up` inside_ has those below too.
    void sum_up() {
        inside_ = own_;
        for (int level = deepest(); level > 0; --level) {
            for (std::size_t z = 0; z < inside_[level].size(); ++z) inside_[level - 1][z / 4] += inside_[level][z];
        }
    }
    // Those of pages that reach into all children of the node, or may.
    std::uint64_t straddling(const FilmNode& node) const {
        const int level = std::min<int>(node.level, deepest());
        return own_[level][slot(level, node)];
    }
    std::uint64_t at_most(const FilmNode& node) const {
        const int level = std::min<int>(node.level, deepest());
        std::size_t z = slot(level, node);
        std::uint64_t bytes = inside_[level][z];
        for (int above = level - 1; above >= 0; --above) bytes += own_[above][z >>= 2];
        return bytes;
    }

 private:
    int deepest() const { return static_cast<int>(own_.size()) - 1; }
    static std::size_t slot(int level, const FilmNode& node) {
        return z_code(static_cast<std::uint32_t>(std::uint64_t{node.x} >> (node.level - level)),
                      static_cast<std::uint32_t>(std::uint64_t{node.y} >> (node.level - level)));
    }

    std::vector<std::vector<std::uint64_t>> own_, inside_;
};

// Regions are as large as memory allows only where pages are that large: small ones stay in the caches and touch less memory. But
// no smaller than to read kLeastRead of a run at once, on average.
constexpr std::uint64_t kComfortable = 32 << 20;
constexpr std::uint64_t kLeastRead = 256 << 10;

struct Plan {
    const FilmGrid& grid;
    const PixelRect& needed;
    const RecordBytes& bytes;
    const RegionLimits& limits;
    std::uint64_t runs;
    std::vector<Region> regions;

    void add(const FilmNode& node) {
        const PixelRect cells = intersection(grid.cells_of(node), needed);
        if (cells.empty()) return;
        const auto windows = static_cast<std::uint64_t>(cells.width() * cells.height()) * limits.window_bytes;
        const std::uint64_t records = bytes.at_most(node);
        const bool fits = records <= limits.resident_bytes || windows <= limits.window_room;
        const bool splits_well =
            std::min(records, windows) > kComfortable && bytes.straddling(node) <= records / 64 && records / 4 >= runs * kLeastRead;
        if (node.level < grid.level() && (!fits || splits_well)) {
            for (int i = 0; i < 4; ++i) add(child(node, i));
        } else {
            regions.push_back({node, cells, records <= limits.resident_bytes});
        }
    }
};

}  // namespace

FilmNode child(const FilmNode& node, int i) {
    return {static_cast<std::uint8_t>(node.level + 1), 2 * node.x + (i & 1), 2 * node.y + (i >> 1)};
}

ZRange z_range(const FilmGrid& grid, const FilmNode& node) {
    const PixelRect cells = grid.cells_of(node);
    return {z_code(static_cast<std::uint32_t>(cells.x0), static_cast<std::uint32_t>(cells.y0)),
            z_code(static_cast<std::uint32_t>(cells.x1 - 1), static_cast<std::uint32_t>(cells.y1 - 1)) + 1};
}

Result<std::vector<Region>> plan_regions(const sampledb::Gathering& gathering, const FilmGrid& grid, const PixelRect& needed,
                                         Classes classes, const Batch& batch, const RegionLimits& limits) {
    RecordBytes bytes(std::min(grid.level(), kCountedLevels));
    for (std::size_t run = 0; run < gathering.runs().size(); ++run) {
        const auto pages = gathering.pages(run);
        if (!pages) return pages.error();
        for (const sampledb::PageInfo& page : **pages) {
            if (classes.has(page.record_class)) bytes.add(page.node, batch.bytes_at_most(page, needed));
        }
    }
    bytes.sum_up();
    Plan plan{grid, needed, bytes, limits, gathering.runs().size(), {}};
    plan.add(FilmNode{});
    return std::move(plan.regions);
}

Status append_pages(const sampledb::Gathering& gathering, const FilmGrid& grid, const Region& region, Classes classes,
                    std::size_t run, std::vector<PageRef>& found) {
    const auto pages = gathering.pages(run);
    if (!pages) return pages.error();
    for (std::uint32_t i = 0; i < (*pages)->size(); ++i) {  // a few nanoseconds each; a page itself takes some hundred thousand
        const sampledb::PageInfo& page = (**pages)[i];
        if (!classes.has(page.record_class) || intersection(grid.cells_of(page.node), region.cells).empty()) continue;
        found.push_back({static_cast<std::uint32_t>(run), i, page});
    }
    return {};
}

}  // namespace latent::develop
