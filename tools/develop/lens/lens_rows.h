// tools/develop/lens/lens_rows.h: loops over records that met a lens, as vectors. The same bits on all processors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace latent::develop {

// Records by their cells of the lens and of time, of 256 each, and their positions on the film.
struct LensRows {
    const std::uint8_t *x = nullptr, *y = nullptr, *time = nullptr;
    const std::uint32_t *u = nullptr, *v = nullptr;

    LensRows from(std::size_t row) const {
        const auto later = [row](const auto* column) { return column != nullptr ? column + row : nullptr; };
        return {later(x), later(y), later(time), later(u), later(v)};
    }
};

// The rear rim of a lens, a unit circle, as records at one place of the film and then another see it. In radii of the lens.
struct RearRim {
    float first_x = 0, first_y = 0;  // middle of the lens's first cell, from that of the rim, at (0, 0) of the film
    float along_u = 0, along_v = 0;  // by how much the rim moves across the film
};

// When the exposure of a row begins, in steps of time, of which there are `per_cell` to a cell.
struct RowSteps {
    float per_cell = 1;
    float begins = 0, later_in_last = 0;  // in the first row; how much later in the last
};
// The transmission of a shutter at each step after that; linear between them.
struct ShutterSteps {
    const float* open = nullptr;
    float last = 0;  // step; one more can be read
    RowSteps rows{};
};

// A value on a patch of the film: at a corner, and what is added to the right of it, below it, and in both directions.
struct Patch {
    static constexpr int kBits = 5, kAcross = 1 << kBits;  // patches across the film
    float corner, right, down, both;
};

// What a lens and a shutter let pass, and how much on average.
struct LensTables {
    const float* cells = nullptr;  // transmission of the lens's cells; null: 1
    std::optional<RearRim> rim{};
    ShutterSteps shutter{};          // none: 1
    const Patch* patches = nullptr;  // the mean over the lens, where it differs over the film; null: 1
    float even_mean = 1;             // mean of all else
};
// The weights of records, and what their light is multiplied by: the same, or that times or divided by the mean weight where they
// lie on the film.
enum class LightFactor : std::uint8_t { kWeight, kTimesMean, kOverMean };
void weigh_rows(const LensTables& tables, const LensRows& rows, LightFactor light, std::span<float> weights,
                std::span<float> light_factors);

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
