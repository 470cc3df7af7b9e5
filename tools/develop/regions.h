// tools/develop/regions.h: the film cut into regions that fit the memory budget. docs/developing.md, "Regions".
#pragma once

#include <cstdint>
#include <vector>

#include "sampledb/gathering.h"
#include "tools/develop/batch.h"
#include "tools/develop/film_grid.h"

namespace latent::develop {

// A node of the film, no smaller than a cell. If its records fit into memory all at once it is `resident`: they are decoded in one
// batch, and the windows of a few cells at a time are filled and finished. Else the windows of all its cells stay in memory while
// the records stream by in batches.
struct Region {
    sampledb::FilmNode node;
    PixelRect cells;  // those of the node that are needed
    bool resident;
};

struct RegionLimits {
    std::uint64_t window_bytes;    // of one cell
    std::uint64_t resident_bytes;  // for the records of a resident region
    std::uint64_t window_room;     // for the windows of another region
};

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

// Regions in Z order that cover `needed` (cells).
Result<std::vector<Region>> plan_regions(const sampledb::Gathering& gathering, const FilmGrid& grid, const PixelRect& needed,
                                         Classes classes, const Batch& batch, const RegionLimits& limits);

// Appends the pages of a run that reach into a region, in the order in which their records are added up.
Status append_pages(const sampledb::Gathering& gathering, const FilmGrid& grid, const Region& region, Classes classes,
                    std::size_t run, std::vector<PageRef>& found);

}  // namespace latent::develop
