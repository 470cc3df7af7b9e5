// render/bsdf/conductor.h: reflection at a metal, smooth or of GGX facets, onwards or back to the light. docs/rendering.md,
// "Surfaces".
#pragma once

#include "render/bsdf/closure.h"
#include "render/bsdf/fresnel.h"
#include "render/bsdf/microfacet.h"

namespace latent::render {

// A retro-reflecting one does to light what it would do to light from the opposite side of the normal [R06 9.6]. With
// `multiscatter`, light that is reflected by several facets is there, too (FacetGain).
class Conductor {
 public:
    static constexpr std::string_view kName = "conductor";
    // Either both parts of the index, or the reflectance at normal incidence.
    static constexpr std::array kInputs = {Input{.name = "eta", .low = 1e-3f, .high = 1e6f, .may_be_missing = true},
                                           Input{.name = "k", .high = 1e6f, .may_be_missing = true},
                                           Input{.name = "reflectance", .may_be_missing = true},
                                           Input::alpha("alpha_x"),
                                           Input::alpha("alpha_y"),
                                           Input::option("retro", 0),
                                           Input::option("multiscatter", 0)};
    static constexpr bool kTransmits = false;

    explicit Conductor(const Values<Conductor>& v)
        : eta_(v.find("eta")),
          k_(v.find("k")),
          facets_(Microfacets::of_alpha(v.number("alpha_x"), v.number("alpha_y"))),
          retro_(v.option("retro") != 0),
          multiscatter_(v.option("multiscatter") != 0) {
        if (const SampledSpectrum* r = v.find("reflectance")) reflect(*r, v.site.spectra);
    }
    static bool is_isotropic(const Values<Conductor>& v) { return v.number("alpha_x") == v.number("alpha_y"); }
    // Its complex index is eta + i k in each wavelength.
    Conductor(const SampledSpectrum& eta, const SampledSpectrum& k, float alpha_x, float alpha_y, bool retro = false,
              bool multiscatter = false)
        : eta_(&eta), k_(&k), facets_(Microfacets::of_alpha(alpha_x, alpha_y)), retro_(retro), multiscatter_(multiscatter) {}

    // The same metal beside matter of index `eta` instead of beside air.
    Conductor beneath(const SampledSpectrum& eta, SampledSpectra& spectra) const;

    const Microfacets& facets() const { return facets_; }
    // The reflectance of a smooth surface in one wavelength.
    float reflectance(float c, std::uint32_t lane) const { return fresnel_conductor(c, (*eta_)[lane], (*k_)[lane]); }
    bool is_delta() const { return facets_.are_smooth(); }
    SampledSpectrum albedo() const { return fresnel_conductor(1, *eta_, *k_); }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    // Becomes the metal of eta = 1 that reflects r at normal incidence.
    void reflect(const SampledSpectrum& r, SampledSpectra& spectra);
    Vec3f turned(const Vec3f& w) const { return retro_ ? Vec3f{-w.x, -w.y, w.z} : w; }

    const SampledSpectrum* eta_;
    const SampledSpectrum* k_;
    Microfacets facets_;
    bool retro_ = false, multiscatter_ = false;
};

}  // namespace latent::render
