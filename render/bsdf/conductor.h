// render/bsdf/conductor.h: reflection at a metal, smooth or of GGX facets. docs/rendering.md, "Surfaces".
#pragma once

#include "render/bsdf/closure.h"
#include "render/bsdf/fresnel.h"
#include "render/bsdf/microfacet.h"

namespace latent::render {

class Conductor {
 public:
    static constexpr bool kTransmits = false;

    // Of complex index eta + i k in each wavelength.
    Conductor(const SampledSpectrum& eta, const SampledSpectrum& k, float alpha_x, float alpha_y)
        : eta_(&eta), k_(&k), facets_(Microfacets::of_alpha(alpha_x, alpha_y)) {}

    const Microfacets& facets() const { return facets_; }
    // Of a smooth surface, in one wavelength.
    float reflectance(float c, std::uint32_t lane) const { return fresnel_conductor(c, (*eta_)[lane], (*k_)[lane]); }
    bool is_delta() const { return facets_.are_smooth(); }
    SampledSpectrum albedo() const { return fresnel_conductor(1, *eta_, *k_); }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    const SampledSpectrum* eta_;
    const SampledSpectrum* k_;
    Microfacets facets_;
};

}  // namespace latent::render
