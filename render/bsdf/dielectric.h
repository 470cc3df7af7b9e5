// render/bsdf/dielectric.h: reflection and refraction at an interface of clear matter, smooth or of GGX facets. docs/rendering.md,
// "Surfaces".
#pragma once

#include "render/bsdf/brushing.h"
#include "render/bsdf/closure.h"
#include "render/bsdf/lost_in_glass.h"
#include "render/bsdf/microfacet.h"
#include "render/bsdf/thin_film.h"

namespace latent::render {

class Dielectric {
 public:
    static constexpr std::string_view kName = "dielectric";
    static constexpr std::array kInputs = joined(
        std::array{Input::index("eta"), Input::alpha("alpha_x"), Input::alpha("alpha_y"),
                   Input{.name = "transmittance", .may_be_missing = true}, Input{.name = "reflectance", .may_be_missing = true}},
        joined(joined(Brushing::kInputs, ThinFilm::kInputs), std::array{Input::option("multiscatter", 0)}));
    static constexpr bool kTransmits = true;

    explicit Dielectric(const Values<Dielectric>& v)
        : Dielectric(v.spectrum("eta"), v.varies("eta"), v.site.kept, v.number("alpha_x"), v.number("alpha_y"),
                     v.find("transmittance"), ThinFilm::of(v), &v.site.spectra.wavelengths, Brushing::of(v),
                     v.option("multiscatter") != 0, v.find("reflectance")) {}
    static bool is_isotropic(const Values<Dielectric>& v) {
        return v.number("alpha_x") == v.number("alpha_y") && !Brushing::is_there(v);
    }
    // `eta`, in each wavelength, is the index behind the surface over that before it, to where its normal points. Refraction by a
    // `dispersive` one follows the `kept` wavelength alone, and so do the probabilities of its lobes. What is refracted is
    // multiplied by `transmittance`, and what is reflected by `tint`, if there is one. A `film` lies on the front side, in air; it
    // is evaluated at `wavelengths`. With `multiscatter`, light that hits several facets is there, too (LostInGlass), unless there
    // is a film.
    Dielectric(const SampledSpectrum& eta, bool dispersive, std::uint32_t kept, float alpha_x, float alpha_y,
               const SampledSpectrum* transmittance = nullptr, const ThinFilm& film = {}, const Wavelengths* wavelengths = nullptr,
               const Brushing& brushing = {}, bool multiscatter = false, const SampledSpectrum* tint = nullptr)
        : eta_(&eta),
          transmittance_(transmittance),
          tint_(tint),
          film_(film),
          wavelengths_(wavelengths),
          kept_(kept),
          eta_kept_(eta[kept]),
          brushing_(brushing),
          facets_(Microfacets::of_alpha(brushing.alpha_along(alpha_x), alpha_y)),
          dispersive_(dispersive),
          multiscatter_(multiscatter && film.share == 0) {}

    bool is_delta() const { return facets_.are_smooth() || (eta_kept_ == 1 && !dispersive_ && film_.share == 0); }
    SampledSpectrum albedo() const { return transmittance_ ? *transmittance_ : SampledSpectrum(1.0f); }
    bool disperses(const Vec3f& w_camera, const Vec3f& w_light) const { return dispersive_ && w_camera.z * w_light.z < 0; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    // What a single facet does.
    void multiply_once(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_once(const Vec3f& wo, const Vec3f& wi) const;
    LostInGlass lost() const { return {eta_kept_, facets_.mean_alpha()}; }
    bool sample_smooth(const Vec3f& wo, float u_lobe, ClosureSample& out, SampledSpectrum& weight) const;
    // For light that hits a facet at cosine c from the side of w: in one wavelength, in each, and how often it is drawn.
    float reflectance(const Vec3f& w, float c, std::uint32_t lane) const;
    SampledSpectrum reflectance(const Vec3f& w, float c) const;
    float probability(const Vec3f& w, float c) const;

    const SampledSpectrum *eta_, *transmittance_, *tint_;
    ThinFilm film_;
    const Wavelengths* wavelengths_;
    std::uint32_t kept_;
    float eta_kept_;
    Brushing brushing_;
    Microfacets facets_;
    bool dispersive_, multiscatter_;
};

}  // namespace latent::render
