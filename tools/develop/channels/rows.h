// tools/develop/channels/rows.h: rows of a page become rows of a batch. The same bits on all processors.
#pragma once

#include <cstdint>
#include <span>

#include "tools/develop/film/film_grid.h"

namespace latent::develop {

// Where positions along one axis lie in the window of their cell.
void place_rows(const FilmGrid::Place& place, std::span<const std::uint32_t> positions, std::uint32_t* places);

// What the values and the shares of rows are multiplied by. Null, both: 1.
struct RowFactors {
    const float* value = nullptr;
    const float* share = nullptr;
};
// Rows of X, Y, Z and `share`, times `factors`; false if X, Y or Z is not finite.
bool interleave_rows(std::span<const float> x, const float* y, const float* z, float share, const RowFactors& factors, float* rows);

}  // namespace latent::develop
