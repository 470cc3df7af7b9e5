// color/rgb_to_spectrum.h: smooth spectra for RGB colours of scenes and textures. Equations: docs/color.md, "RGB to spectrum".
#pragma once

#include "color/rgb_space.h"
#include "color/spectrum.h"

namespace latent::color {

// scale S(c0 t^2 + c1 t + c2),  S(x) = 1/2 + x / (2 sqrt(1 + x^2)),  t = (lambda - 595 nm) / 235 nm      [JH19]
struct SigmoidSpectrum {
    float c0 = 0, c1 = 0, c2 = 0;
    float scale = 0;

    float operator()(float lambda_nm) const;
    float max_value() const;  // over 360..830 nm
};

// Spectra of the colours of one RGB space. Solves each colour by itself (40 microseconds), no table.
class RgbToSpectrum {
 public:
    // `illuminant` is the space's white (D65 for all of RgbSpace::names()): under it a constant 1 is RGB (1,1,1).
    RgbToSpectrum(const RgbSpace& space, const Spectrum& illuminant);

    // Reflectance within [0,1]: components are clamped to [0,1] first; grey g is exactly g at every wavelength, black 0, white 1.
    // Dark colours are dimmed bright ones: with max(rgb) < 1/2 the spectrum is proportional to rgb.
    SigmoidSpectrum reflectance(Rgb rgb) const;
    // Any non-negative magnitude (media, and lights, whose radiance is this times the illuminant); negative components count as 0.
    SigmoidSpectrum unbounded(Rgb rgb) const;

    // Linear RGB of a reflectance seen under the illuminant: the way back.
    Rgb rgb_of(const SigmoidSpectrum& s) const;
    const Spectrum& illuminant() const { return illuminant_; }

 private:
    // RGB of S(c0 t^2 + c1 t + c2) and its derivatives after c0, c1, c2.
    struct Linearised {
        std::array<double, 3> rgb;
        Matrix3 jacobian;
    };
    Linearised linearised_at(const std::array<double, 3>& c) const;
    std::array<double, 3> coefficients_of(const std::array<double, 3>& rgb) const;
    SigmoidSpectrum spectrum_of(Rgb rgb, double scale) const;  // rgb / scale in [0,1]

    Spectrum illuminant_;
    // Weight of each integer nm in r, g and b: rgb_from_xyz (xbar, ybar, zbar) illuminant, normalised.
    std::array<std::array<double, 3>, kIntegerNmCount> weight_;
};

}  // namespace latent::color
