#include "render/texture/rgb_spectrum.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace latent::render {

RgbColors::RgbColors(color::RgbSpectra kind, SpectrumLibrary& library) {
    if (kind == color::RgbSpectra::kSmooth) {
        lattice_ = &color::RgbLattice::srgb();
        return;
    }
    for (std::size_t i = 0; i < 3; ++i) basis_[i] = library.add(color::rgb_basis()[i], Lookup::kLinear);
}

void RgbColors::evaluate(const float* rgb, SpectrumRole role, SampledSpectra& spectra, SampledSpectrum& out) const {
    if (lattice_ == nullptr) {
        const float most = role == SpectrumRole::kReflectance ? 1 : std::numeric_limits<float>::max();
        const SampledSpectrum* const curves[3] = {&spectra[basis_[0]], &spectra[basis_[1]], &spectra[basis_[2]]};
        out = SampledSpectrum(0.0f);
        for (std::size_t c = 0; c < 3; ++c) out += *curves[c] * std::clamp(rgb[c], 0.0f, most);
        return;
    }
    const Wavelengths& w = spectra.wavelengths;
    constexpr float kCentre = 595, kHalfWidth = 235;
    float scale = 1;
    if (role == SpectrumRole::kUnbounded) scale = 2 * std::max({rgb[0], rgb[1], rgb[2], 0.0f});
    out = SampledSpectrum(0.0f);
    if (!(scale > 0)) return;
    const color::RgbLattice::Blend blend = lattice_->reflectance(rgb[0] / scale, rgb[1] / scale, rgb[2] / scale);
    for (std::size_t n = 0; n < 4; ++n) {
        const color::SigmoidSpectrum& s = *blend.node[n];
        const float weight = blend.weight[n] * s.scale * scale;
        if (weight == 0) continue;
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            const float t = (w.lambda_nm[i] - kCentre) / kHalfWidth;
            const float x = (s.c0 * t + s.c1) * t + s.c2;
            const float root = std::sqrt(1 + x * x), low = 0.5f / (root * (root + std::abs(x)));
            out.v[i] += weight * (x < 0 ? low : 1 - low);
        }
    }
}

}  // namespace latent::render
