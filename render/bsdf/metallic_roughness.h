// render/bsdf/metallic_roughness.h: a blend of a rough metal and of a diffuse body under a rough dielectric surface, and a clear
// coat above both: glTF's material. docs/rendering.md, "Surfaces".
#pragma once

#include "render/bsdf/brushing.h"
#include "render/bsdf/closure.h"
#include "render/bsdf/microfacet.h"
#include "render/bsdf/schlick_albedo.h"
#include "render/bsdf/thin_film.h"

namespace latent::render {

// Facets are GGX, reflectances Schlick's: of the metal from the base colour b to 1, of the dielectric from f0, times a colour if
// there is one, to f90. With E(mu) the albedo of the dielectric's facets, in each wavelength [KelemenSzirmayKalos01], E_c that of
// the coat times its share:
//   f = (1 - E_c(a)) (1 - E_c(b)) (metallic f_metal + (1 - metallic) (f_facets + b (1 - E(a)) (1 - E(b)) / (pi (1 - mean E))))
//       + coat f_coat
// Reciprocal while the coat's normal is that of the surface; a white dielectric returns all it gets. The same from both sides.
// Below the coat, a thin film may lie on both the metal and the dielectric: its reflectance then counts instead of Schlick's, in
// the share that it covers. What belongs to the coat is measured from its own normal, cosines too. With `multiscatter`, the facets
// of metal and dielectric have a FacetGain, unless there is a film.
class MetallicRoughness {
 public:
    static constexpr std::string_view kName = "metallicroughness";
    // Alphas are the squares of roughnesses.
    static constexpr std::array kInputs =
        joined(std::array{Input::reflectance("base_color"), Input::number("roughness", 1, 0, 1), Input::number("metallic", 0, 0, 1),
                          Input::number("f0", 0.04f, 0, 1), Input::number("f90", 1, 0, 1), Input::number("coat", 0, 0, 1),
                          Input::number("coat_roughness", 0, 0, 1), Input{.name = "specular_color", .may_be_missing = true}},
               joined(joined(Brushing::kInputs, ThinFilm::kInputs), std::array{Input::option("multiscatter", 0)}));
    static constexpr bool kTransmits = false;

    struct Parameters {
        float metallic = 0, alpha = 1;
        float f0 = 0.04f, f90 = 1;
        float coat = 0, coat_alpha = 0;  // coat: the share of the surface that it covers
        Brushing brushing{};
        ThinFilm film{};
        bool multiscatter = false;
    };
    // Metal alone is a mirror if it is smooth. What lies on a body or below a coat has facets that are never smoother than
    // kMinAlpha: a mirror would leave the rest of the surface undrawn.
    static constexpr float kMinAlpha = 0.002f;
    explicit MetallicRoughness(const Values<MetallicRoughness>& v);
    template <class C>
    static bool is_isotropic(const Values<C>& v) {
        return !Brushing::is_there(v);
    }
    // `specular_color`: of f0; null: white. A film needs `spectra`, at whose wavelengths it is evaluated.
    MetallicRoughness(const SampledSpectrum& base, const Parameters& parameters, const SampledSpectrum* specular_color = nullptr,
                      SampledSpectra* spectra = nullptr);

    bool is_delta() const { return mirrors_; }
    bool is_coated() const { return coat_ > 0; }
    // The same with facets, however smooth the metal.
    MetallicRoughness with_facets() const {
        MetallicRoughness out = *this;
        out.mirrors_ = false;
        return out;
    }
    // The same, whose coat has this normal.
    MetallicRoughness with_coat_normal(const Vec3f& n) const {
        MetallicRoughness out = *this;
        out.coat_n_ = n;
        return out;
    }
    SampledSpectrum albedo() const { return *base_; }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    // Probabilities of the coat's and the surface's facets; the rest is diffuse. About their shares of what leaves towards wo.
    struct Lobes {
        float coat, facets;
    };
    Lobes lobes(const Vec3f& wo) const;
    Frame coat_frame() const { return Frame::from_z(coat_n_); }

    // What a film needs.
    struct Filmed {
        ThinFilm film;
        const float* lambda_nm;
        SampledSpectrum f0, dielectric_eta, metal_eta;
        SampledSpectrum at_node[FacetWeights::kNodes];  // what the dielectric's facets reflect
        float mean_at_node[FacetWeights::kNodes];       // over the wavelengths
    };
    Filmed filmed(const ThinFilm& film, const Wavelengths& wavelengths) const;
    // The albedo of the dielectric's facets in each wavelength.
    SampledSpectrum filmed_albedo(const FacetWeights& weights) const;
    // By a mirror, at cosine c.
    SampledSpectrum reflectance(float c) const;
    // What lies below the coat, f without the base's cosine. c: at the facets; d: D G / (4 cos cos), 0 if there are none between.
    SampledSpectrum filmed_surface(float mu, float mu_light, float c, float d) const;
    SampledSpectrum multiscatter_surface(float mu, float mu_light, float c, float d) const;

    const SampledSpectrum *base_, *specular_color_;
    bool multiscatter_, mirrors_;
    float brightest_, metallic_, f0_, f90_, coat_, alpha_;  // alpha: of isotropic facets of the same albedo, about
    Brushing brushing_;
    const Filmed* filmed_ = nullptr;
    Microfacets facets_, coat_facets_;
    Vec3f coat_n_{0, 0, 1};
    // The metal and the dielectric where they reflect most; the dielectric where it reflects least; the coat.
    SchlickAlbedo metal_albedo_, albedo_, min_albedo_, coat_albedo_;
};

}  // namespace latent::render
