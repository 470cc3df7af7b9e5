// color/film/exposure.h: a film as an observer: what light does to its layers in the camera. Equations: docs/color.md, "Film".
#pragma once

#include "base/result.h"
#include "color/film/material.h"
#include "color/observer.h"

namespace latent::film {

// Exposures of the layers [lux s], of radiances on the scale where a white card has Y = 1: a grey card of 18 % under the light that
// the film is balanced for gives each layer 10 / `exposure_index`, as speeds are defined [ISO12232]. Black and white: three times
// the same. Errors: those of the table of sensitivities.
Result<color::Observer> film_observer(const Material& material, double exposure_index);

}  // namespace latent::film
