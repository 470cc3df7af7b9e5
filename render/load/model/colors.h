// render/load/model/colors.h: spectra for the linear rgb values of models, whose primaries are sRGB's.
#pragma once

#include <array>

#include "color/rgb_basis.h"
#include "color/rgb_to_spectrum.h"
#include "color/spectrum.h"

namespace latent::render {

using LinearRgb = std::array<double, 3>;

class ModelColors {
 public:
    explicit ModelColors(color::RgbSpectra kind);

    // Components are clamped to [0,1]; a grey is constant.
    color::Spectrum reflectance(const LinearRgb& rgb) const;
    // Light of this colour under D65, of any magnitude: rgb (1, 1, 1) has Y = 1.
    color::Spectrum emission(const LinearRgb& rgb) const;

 private:
    color::RgbSpectra kind_;
    color::RgbToSpectrum rgb_;
    color::Spectrum white_;  // D65 with Y = 1
};

}  // namespace latent::render
