#include "render/material/fibre.h"

#include "render/material/values.h"
#include "render/math/elementary.h"

namespace latent::render {

HairSource::HairSource(const HairDescription& d, const Textures& textures, SpectrumLibrary& library)
    : has_color_(d.has_color),
      sigma_a_(textures.source(d.sigma_a, library)),
      color_(textures.source(d.color, library)),
      eta_(textures.source(d.eta)),
      beta_m_(textures.source(d.beta_m)),
      beta_n_(textures.source(d.beta_n)),
      alpha_degrees_(textures.source(d.alpha_degrees)) {}

Fibre HairSource::at(const TexturePoint& point) const {
    Fibre fibre{.sigma_a = nullptr,
                .eta = within(eta_, 1.0001f, 10, point),
                .beta_m = within(beta_m_, 0, 1, point),
                .beta_n = within(beta_n_, 0, 1, point),
                .tilt_turns = within(alpha_degrees_, -45, 45, point) / 360};
    if (!has_color_) {
        fibre.sigma_a = &within(sigma_a_, 0, 1e6f, point);
        return fibre;
    }
    // Such that much hair together has this colour [Chiang16 eq. 9].
    const float n = fibre.beta_n;
    const float slope = 5.969f + n * (-0.215f + n * (2.532f + n * (-10.73f + n * (5.574f + n * 0.245f))));
    const SampledSpectrum& color = reflectance(color_, point);
    SampledSpectrum& sigma_a = point.spectra->allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        const float root = log_positive(std::max(color.v[i], 1e-6f)) / slope;
        sigma_a.v[i] = root * root;
    }
    fibre.sigma_a = &sigma_a;
    return fibre;
}

}  // namespace latent::render
