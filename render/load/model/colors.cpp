#include "render/load/model/colors.h"

#include <algorithm>

#include "color/named_spectra.h"
#include "color/observer.h"

namespace latent::render {

namespace {

color::Spectrum clamped_spectrum(const std::function<double(double)>& f) {
    return color::Spectrum::from_function(f, color::Outside::kClamped);
}

bool is_grey(const LinearRgb& rgb) { return rgb[0] == rgb[1] && rgb[1] == rgb[2]; }

}  // namespace

ModelColors::ModelColors(color::RgbSpectra kind)
    : kind_(kind),
      rgb_(color::RgbSpace::srgb(), color::illuminant_d65()),
      white_(rgb_.illuminant().scaled(1 / color::photometric_sum(rgb_.illuminant()))) {}

color::Spectrum ModelColors::reflectance(const LinearRgb& rgb) const {
    if (is_grey(rgb)) return color::Spectrum::constant(std::clamp(rgb[0], 0.0, 1.0));
    if (kind_ == color::RgbSpectra::kBasis) {
        return color::rgb_basis_spectrum({std::min(rgb[0], 1.0), std::min(rgb[1], 1.0), std::min(rgb[2], 1.0)});
    }
    return clamped_spectrum([s = rgb_.reflectance({rgb[0], rgb[1], rgb[2]})](double nm) { return s(static_cast<float>(nm)); });
}

color::Spectrum ModelColors::emission(const LinearRgb& rgb) const {
    if (is_grey(rgb)) return clamped_spectrum([&](double nm) { return rgb[0] * white_(nm); });
    if (kind_ == color::RgbSpectra::kBasis) {
        const color::Spectrum s = color::rgb_basis_spectrum({rgb[0], rgb[1], rgb[2]});
        return clamped_spectrum([&](double nm) { return s(nm) * white_(nm); });
    }
    return clamped_spectrum(
        [&, s = rgb_.unbounded({rgb[0], rgb[1], rgb[2]})](double nm) { return s(static_cast<float>(nm)) * white_(nm); });
}

}  // namespace latent::render
