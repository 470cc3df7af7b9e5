// render/light/rgb_illuminant.h: light of any rgb, as what multiplies an illuminant. docs/rendering.md, "Lights".
#pragma once

#include <cstdint>

#include "color/rgb_basis.h"
#include "color/rgb_space.h"
#include "render/spectral/spectra.h"

namespace latent::render {

// The spectrum of rgb is a sum of smooth ones of fixed colours, so that no pixel needs to be solved for: the smallest component of
// white (1 at every wavelength), what the middle one exceeds it by of the secondary colour of the two larger ones, the rest of the
// largest's primary [Smits99]. Its colour under D65 is rgb exactly, as colours add up. Or it is that of color::rgb_basis().
class RgbIlluminant {
 public:
    RgbIlluminant(SpectrumLibrary& library, color::RgbSpectra kind);
    void multiply(const float* rgb, SampledSpectra& spectra, SampledSpectrum& value) const;

 private:
    bool is_basis_;
    std::uint32_t basis_[6];  // red, green, blue, cyan, magenta, yellow; or only the first three
};

inline double luminance(const float* rgb) {
    const auto& row = color::RgbSpace::srgb().luminance_row;
    return row[0] * static_cast<double>(rgb[0]) + row[1] * static_cast<double>(rgb[1]) + row[2] * static_cast<double>(rgb[2]);
}

}  // namespace latent::render
