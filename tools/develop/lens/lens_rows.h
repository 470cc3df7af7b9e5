// tools/develop/lens/lens_rows.h: what a lens does to the records of a page, many at a time. The same bits on all processors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "tools/develop/film/film_grid.h"
#include "tools/develop/lens/aperture.h"

namespace latent::develop {

// Where records meet the film, in units of 2^-32.
struct FilmRows {
    const std::uint32_t *u, *v;
};
// Their cells of the lens.
struct LensRows {
    const std::uint8_t *x, *y;
};

// The transmission of each record's cell, of kLensCells x kLensCells.
void transmissions(const float* cells, const LensRows& lens, std::span<float> out);

// The rear rim: a circle like the lens. Its middle, in radii from that of the lens, of records at (0, 0) of the film; and how far
// it moves to the other side of the film.
struct RearRim {
    float x = 0, y = 0, per_u = 0, per_v = 0;
};
// Multiplies by the share of each record's cell of the lens that lies within it.
void pass_rear_rim(const RearRim& rim, const FilmRows& film, const LensRows& lens, std::span<float> out);

// A function over the film, bilinear on kPatches x kPatches patches: at a corner, and what is added to the right of it, below it,
// and in both directions.
inline constexpr int kPatchBits = 5, kPatches = 1 << kPatchBits;
struct Patch {
    float corner, right, down, both;
};
// Its values, times `factor`.
void on_patches(const Patch* patches, const FilmRows& film, float factor, std::span<float> out);

// How far records are moved along an axis of the film, from each cell along the same axis of the lens, in units of 2^-31.
using LensMoves = std::array<std::int32_t, kLensCells>;
// Moves records, modulo 1, and finds their cells of a film that is cut into 2^level x 2^level: counted row by row within `wanted`,
// or the number behind its last.
void move_on_film(const std::array<LensMoves, 2>& moves, const LensRows& lens, int level, const PixelRect& wanted,
                  std::span<std::uint32_t> u, std::uint32_t* v, std::uint32_t* cells);

}  // namespace latent::develop
