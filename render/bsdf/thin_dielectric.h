// render/bsdf/thin_dielectric.h: a pane of clear matter, smooth or of GGX facets, with all reflections between its faces.
// docs/rendering.md, "Surfaces".
#pragma once

#include "render/bsdf/brushing.h"
#include "render/bsdf/closure.h"
#include "render/bsdf/microfacet.h"
#include "render/bsdf/thin_film.h"

namespace latent::render {

class ThinDielectric {
 public:
    static constexpr std::string_view kName = "thindielectric";
    static constexpr std::array kInputs = joined(std::array{Input::index("eta"), Input::alpha("alpha_x"), Input::alpha("alpha_y"),
                                                            Input{.name = "transmittance", .may_be_missing = true}},
                                                 joined(Brushing::kInputs, ThinFilm::kInputs));
    static constexpr bool kTransmits = true;

    explicit ThinDielectric(const Values<ThinDielectric>& v)
        : ThinDielectric(v.spectrum("eta"), v.varies("eta"), v.site.kept, v.number("alpha_x"), v.number("alpha_y"),
                         v.find("transmittance"), ThinFilm::of(v), &v.site.spectra.wavelengths, Brushing::of(v)) {}
    static bool is_isotropic(const Values<ThinDielectric>& v) {
        return v.number("alpha_x") == v.number("alpha_y") && !Brushing::is_there(v);
    }
    // `eta` in each wavelength. Nothing is refracted: all wavelengths go on together, with the probabilities of the `kept` one.
    // What passes is multiplied by `transmittance`, if there is one. A `film` lies on both faces; it is evaluated at
    // `wavelengths`, whose mean then counts instead of the kept one.
    ThinDielectric(const SampledSpectrum& eta, bool dispersive, std::uint32_t kept, float alpha_x = 0, float alpha_y = 0,
                   const SampledSpectrum* transmittance = nullptr, const ThinFilm& film = {},
                   const Wavelengths* wavelengths = nullptr, const Brushing& brushing = {})
        : eta_(&eta),
          transmittance_(transmittance),
          film_(film),
          wavelengths_(wavelengths),
          eta_kept_(eta[kept]),
          brushing_(brushing),
          facets_(Microfacets::of_alpha(brushing.alpha_along(alpha_x), alpha_y)),
          dispersive_(dispersive) {}

    bool is_delta() const { return facets_.are_smooth(); }
    SampledSpectrum albedo() const { return transmittance_ ? *transmittance_ : SampledSpectrum(1.0f); }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    // For light that hits a facet at cosine c: in each wavelength, and how often it is drawn.
    SampledSpectrum reflectance(float c) const;
    float probability(float c) const;

    const SampledSpectrum *eta_, *transmittance_;
    ThinFilm film_;
    const Wavelengths* wavelengths_;
    float eta_kept_;
    Brushing brushing_;
    Microfacets facets_;
    bool dispersive_;
};

}  // namespace latent::render
