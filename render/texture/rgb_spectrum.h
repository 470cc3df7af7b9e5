// render/texture/rgb_spectrum.h: the colour of a picture at the wavelengths of a sample.
#pragma once

#include "color/rgb_lattice.h"
#include "render/scene/texture.h"
#include "render/spectral/spectra.h"

namespace latent::render {

// Linear sRGB under D65 as a spectrum, of which negative components count as 0. A reflectance is within [0,1]; an unbounded
// spectrum is 2 m times the reflectance of rgb / (2 m), m the largest component, as of rgb parameters.
void spectrum_of_rgb(const color::RgbLattice& lattice, const float* rgb, SpectrumRole role, const Wavelengths& w,
                     SampledSpectrum& out);

}  // namespace latent::render
