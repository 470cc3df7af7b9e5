// color/film/blur.h: how far light spreads in a film before it is developed. Equations: docs/color.md, "Light that spreads".
#pragma once

#include "base/result.h"
#include "color/film/material.h"
#include "color/film/spectra.h"

namespace latent::film {

// Cycles per mm of which each layer keeps half the contrast, by the data sheet. Errors: of the table; kUnsupported if the film has
// none.
Result<Triple> half_contrast(const Material& film);
// What is left of the contrast at a frequency: 1 / (1 + (f / half)^2). Its point spread function is not negative anywhere.
double contrast_left(double half, double cycles_per_mm);

// Light that returns from the back of the base, at this distance from where it fell [um]: per area, of any scale; 0 beyond 1 mm.
double returned_light(double um);
// How much of the light of each layer does so: of a film whose back absorbs light, or of one without such a layer.
Triple returned_share(const Material& film, bool bare);

}  // namespace latent::film
