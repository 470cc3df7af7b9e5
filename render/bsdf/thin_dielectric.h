// render/bsdf/thin_dielectric.h: a smooth pane of clear matter, with all reflections between its faces. docs/rendering.md,
// "Surfaces".
#pragma once

#include "render/bsdf/closure.h"
#include "render/bsdf/thin_film.h"

namespace latent::render {

class ThinDielectric {
 public:
    static constexpr std::string_view kName = "thindielectric";
    static constexpr std::array kInputs =
        joined(std::array{Input::index("eta"), Input{.name = "transmittance", .may_be_missing = true}}, ThinFilm::kInputs);
    static constexpr bool kTransmits = true;

    explicit ThinDielectric(const Values<ThinDielectric>& v)
        : ThinDielectric(v.spectrum("eta"), v.varies("eta"), v.site.kept, v.find("transmittance"), ThinFilm::of(v),
                         &v.site.spectra.wavelengths) {}
    // `eta` in each wavelength. Nothing is refracted: all wavelengths go on together, with the probabilities of the `kept` one.
    // What goes straight on is multiplied by `transmittance`, if there is one. A `film` lies on both faces; it is evaluated at
    // `wavelengths`, whose mean then counts instead of the kept one.
    ThinDielectric(const SampledSpectrum& eta, bool dispersive, std::uint32_t kept, const SampledSpectrum* transmittance = nullptr,
                   const ThinFilm& film = {}, const Wavelengths* wavelengths = nullptr)
        : eta_(&eta),
          transmittance_(transmittance),
          film_(film),
          wavelengths_(wavelengths),
          eta_kept_(eta[kept]),
          dispersive_(dispersive) {}

    bool is_delta() const { return true; }
    SampledSpectrum albedo() const { return transmittance_ ? *transmittance_ : SampledSpectrum(1.0f); }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f&, const Vec3f&, SampledSpectrum& value) const { value = SampledSpectrum(0.0f); }
    float pdf_omega(const Vec3f&, const Vec3f&) const { return 0; }
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    const SampledSpectrum *eta_, *transmittance_;
    ThinFilm film_;
    const Wavelengths* wavelengths_;
    float eta_kept_;
    bool dispersive_;
};

}  // namespace latent::render
