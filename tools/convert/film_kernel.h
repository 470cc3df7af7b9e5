// tools/convert/film_kernel.h: how the light of a pixel spreads in the film. Equations: docs/color.md, "Light that spreads".
#pragma once

#include <optional>

#include "color/film/blur.h"
#include "image/kernel.h"

namespace latent::convert {

struct FilmBlur {
    std::optional<film::Triple> half;  // cycles per mm of half the contrast; none: as sharp as can be
    film::Triple returned{};           // share of the light that returns from the back of the base

    bool returns_light() const { return returned[0] > 0 || returned[1] > 0 || returned[2] > 0; }
};

// For pixels of this size on the film. Light goes no farther than `max_radius` pixels.
image::Kernel sharpness_kernel(const film::Triple& half, double pixel_um, int max_radius);
// For cells of this size.
image::Kernel returned_kernel(const film::Triple& share, double cell_um, int max_radius);

// Pixels along a side of the cells that light returns from and to: up to 10 um, beside which its way is long.
int returned_cell(double pixel_um);

}  // namespace latent::convert
