// tools/develop/lens/lens_rows.h: loops over records that met a lens, as vectors. The same bits on all processors.
#pragma once

#include <cstdint>
#include <span>

namespace latent::develop {

// The rear rim of a lens, a unit circle, as records at one place of the film and then another see it. In radii of the lens.
struct RearRim {
    float first_x, first_y;  // of the middle of the lens's first cell, from that of the rim, at (0, 0) of the film
    float along_u, along_v;  // by how much the rim moves across the film
};
// Multiplies weights by the share of each record's cell (x, y) of the lens that lies within the rim.
void weigh_by_rim(const RearRim& rim, const std::uint8_t* x, const std::uint8_t* y, const std::uint32_t* u, const std::uint32_t* v,
                  std::span<float> weights);

// How far a lens that is focused elsewhere moves records along u or v, and which cells of the film are wanted.
struct AxisMove {
    float shift;                      // per radius of the lens
    std::uint32_t first_cell, count;  // cells of the film; there are 2^level
};
// Moves records by their cells (x, y) of the lens. `cells`: where they come to lie: numbers among the wanted cells, row by row;
// that behind the last for records elsewhere, whose positions then mean nothing. Rounds positions to 2^-31.
void move_positions(const AxisMove& along_u, const AxisMove& along_v, int level, const std::uint8_t* x, const std::uint8_t* y,
                    std::uint32_t* u, std::uint32_t* v, std::span<std::uint32_t> cells);

}  // namespace latent::develop
