// tools/develop/rows.h: rows of a page become rows of a batch. The same bits on all processors.
#pragma once

#include <cstdint>
#include <span>

#include "tools/develop/film_grid.h"

namespace latent::develop {

// Where positions along one axis lie in the window of their cell.
void place_rows(const FilmGrid::Place& place, std::span<const std::uint32_t> positions, std::uint32_t* places);

// Rows of X, Y, Z and `share`; false if one of them is not finite.
bool interleave_rows(std::span<const float> x, const float* y, const float* z, float share, float* rows);

}  // namespace latent::develop
