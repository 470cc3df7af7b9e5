// tools/develop/film/windows.h: the sums of the cells of a pane: a node of the film whose cells are finished together.
// docs/developing.md, "Cells".
#pragma once

#include <cstdint>
#include <vector>

#include "tools/develop/film/film_grid.h"

namespace latent::develop {

// Windows of its cells, in float64, `stride` sums per pixel; null where a cell has no such records.
struct Windows {
    PixelRect cells;
    struct Cell {
        const double* camera = nullptr;
        const double* light = nullptr;
    };
    std::vector<Cell> of;  // row after row
    const Cell& at(std::int64_t x, std::int64_t y) const { return of[(y - cells.y0) * cells.width() + (x - cells.x0)]; }
};

}  // namespace latent::develop
