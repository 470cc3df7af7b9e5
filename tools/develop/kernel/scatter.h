// tools/develop/kernel/scatter.h: rows in any order of cells, to the segments of their cells. The same bits on all processors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "tools/develop/kernel/splat.h"

namespace latent::develop {

// Rows by their cells and positions, with `stride` values each.
struct ScatteredRows {
    std::span<const std::uint32_t> cells;
    const std::uint32_t *u, *v;
    const float* values;
    std::size_t stride;
};
// The rows of a cell: so many, in columns that have room for more.
struct CellSpace {
    SegmentColumns columns;
    std::uint32_t kept, room;
};
// Appends rows to those of their cells, positions as x and y, in the order that they have. Rows of the last cell are left out, and,
// if `drops_zeros`, rows of zeros, which add nothing to any sum: that cell keeps nothing, and needs room for all rows of a call.
void scatter(const ScatteredRows& rows, bool drops_zeros, std::span<CellSpace> cells);

// Takes rows of zeros out of columns. Returns how many rows are left.
std::uint32_t drop_zeros(const SegmentColumns& columns, std::uint32_t count, std::size_t stride);

}  // namespace latent::develop
