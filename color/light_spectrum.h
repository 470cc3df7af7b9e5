// color/light_spectrum.h: spectra of lights, whose lines may be finer than the nm that tables count in. docs/rendering.md,
// "Wavelengths".
#pragma once

#include "color/spectrum.h"

namespace latent::color {

// The same spectrum, but lines (isolated by zeros, or all there is) narrower than 0.05 nm are stretched to it about their middle,
// their area kept: float wavelengths could not tell where in a finer line they are.
Spectrum with_lines_widened(const Spectrum& s);

// Y of a light of spectrum `s` (CIE 1931, no 683) as a renderer evaluates it: pbrt's sum over whole nm, or the exact integral over
// 360..830 nm if it has fine lines. A light's spectrum is divided by it, so seen directly it has Y = 1.
double luminance(const Spectrum& s);

// True if a table of one value per nm cannot hold `s`: some knots in 360..830 nm are less than 1 nm apart.
bool has_fine_lines(const Spectrum& s);

}  // namespace latent::color
