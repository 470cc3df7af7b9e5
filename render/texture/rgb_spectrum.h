// render/texture/rgb_spectrum.h: the colour of a picture at the wavelengths of a sample.
#pragma once

#include <array>

#include "color/rgb_basis.h"
#include "color/rgb_lattice.h"
#include "render/scene/texture.h"
#include "render/spectral/spectra.h"

namespace latent::render {

// Linear sRGB under D65 as a spectrum, of which negative components count as 0. A reflectance is within [0,1]; an unbounded
// spectrum is 2 m times the reflectance of rgb / (2 m), m the largest component, as of rgb parameters. Or that of
// color::rgb_basis().
class RgbColors {
 public:
    RgbColors(color::RgbSpectra kind, SpectrumLibrary& library);
    void evaluate(const float* rgb, SpectrumRole role, SampledSpectra& spectra, SampledSpectrum& out) const;

 private:
    const color::RgbLattice* lattice_ = nullptr;  // null: by the basis
    std::array<std::uint32_t, 3> basis_{};        // spectra of the library
};

}  // namespace latent::render
