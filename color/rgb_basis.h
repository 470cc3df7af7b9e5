// color/rgb_basis.h: spectra of RGB colours as sums of three curves [R06 5.3.4]. Equations: docs/color.md, "RGB to spectrum".
#pragma once

#include <array>
#include <cstdint>

#include "color/rgb_space.h"
#include "color/spectrum.h"

namespace latent::color {

// What the colours of a scene stand for: spectra that are solved for each (RgbToSpectrum), or the sum of three.
enum class RgbSpectra : std::uint8_t { kSmooth, kBasis };

// R r(lambda) + G g(lambda) + B b(lambda) of linear sRGB. The curves are cubic splines, nowhere negative, and add up to 1, so a
// grey is constant; under D65 each has the colour of its primary.
const std::array<Spectrum, 3>& rgb_basis();
// Negative components count as 0.
Spectrum rgb_basis_spectrum(Rgb srgb);

}  // namespace latent::color
