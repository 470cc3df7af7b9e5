// render/spectral/wavelength_density.h: the density that a job draws its wavelengths from. docs/rendering.md, "Wavelengths".
#pragma once

#include <vector>

#include "color/spectrum.h"
#include "sampledb/data/wavelengths.h"

namespace latent::render {

// The spectrum of a light and how much of it there is.
struct LightSpectrum {
    color::Spectrum spectrum;
    double luminous_power = 0;  // any unit, the same for all lights of a scene
};

//   p = 0.63 p_eye + 0.09 / 470 nm + 0.28 p_spike    on 360..830 nm
// p_eye is color::visible_pdf_lambda. p_spike mixes, by luminous power, the normalised spectra of the lights with lines: those that
// somewhere exceed four times their own mean as the eye weighs it, s(lambda) > 4 integral(s p_eye). Without such a light its share
// goes to p_eye. This is the balance heuristic between three ways to draw one batch, which all strategies of a sample share
// [RBA09]. Q has knots at every nm, and where the spectra of lights with lines have theirs: p is constant in between. Near knots
// are joined until a header holds them all. Values of Q are rounded to 2^-32, so that the last bit of some libm cannot make another
// job of the same scene.
sampledb::WavelengthDensity wavelength_density(const std::vector<LightSpectrum>& lights);

}  // namespace latent::render
