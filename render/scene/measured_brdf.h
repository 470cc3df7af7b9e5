// render/scene/measured_brdf.h: reflection as it was measured, in the tables of [DupuyJakob18]. docs/rendering.md, "Measured
// surfaces".
#pragma once

#include <cstdint>
#include <vector>

#include "base/hash.h"

namespace latent::render {

// Values at the points of a lattice over the unit square, row after row.
struct SquareTable {
    std::uint32_t width = 2, height = 2;
    std::vector<float> values{};
};

// Directions are points of the unit square: x = sqrt(2 theta / pi), y = phi / (2 pi) + 1/2. There is a table of `vndf`, `luminance`
// and `spectra` for every direction (phi, theta) of a lattice of theirs, theta first.
struct MeasuredBrdf {
    Hash128 content{};                  // hash of the file
    std::vector<float> phi{}, theta{};  // [radians], ascending: of that lattice
    std::vector<float> lambda_nm{};     // ascending
    SquareTable ndf{}, sigma{};         // density of facets, and their projected area
    SquareTable vndf{};                 // density of the facets that are seen; not normalised
    SquareTable luminance{};            // over the square that `vndf` is warped to; not normalised
    SquareTable spectra{};              // over the same: at each point one value for each wavelength, not below 0
    bool is_isotropic() const { return phi.size() <= 2; }
};

}  // namespace latent::render
