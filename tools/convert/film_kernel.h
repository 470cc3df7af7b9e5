// tools/convert/film_kernel.h: how the light of a pixel spreads in the film. Equations: docs/color.md, "Light that spreads".
#pragma once

#include <optional>

#include "color/film/blur.h"
#include "image/kernel.h"

namespace latent::convert {

struct FilmBlur {
    std::optional<film::Triple> half;  // cycles per mm of half the contrast; none: as sharp as can be
    film::Triple returned{};           // from the back of the base
};

// Of pixels of this size on the film. Light goes no farther than `most_radius` pixels.
image::Kernel film_kernel(const FilmBlur& blur, double pixel_um, int most_radius);

}  // namespace latent::convert
