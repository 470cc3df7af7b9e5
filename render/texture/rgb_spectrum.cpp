#include "render/texture/rgb_spectrum.h"

#include <algorithm>
#include <cmath>

namespace latent::render {

void spectrum_of_rgb(const color::RgbLattice& lattice, const float* rgb, SpectrumRole role, const Wavelengths& w,
                     SampledSpectrum& out) {
    constexpr float kCentre = 595, kHalfWidth = 235;
    float scale = 1;
    if (role == SpectrumRole::kUnbounded) scale = 2 * std::max({rgb[0], rgb[1], rgb[2], 0.0f});
    out = SampledSpectrum(0.0f);
    if (!(scale > 0)) return;
    const color::RgbLattice::Blend blend = lattice.reflectance(rgb[0] / scale, rgb[1] / scale, rgb[2] / scale);
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
