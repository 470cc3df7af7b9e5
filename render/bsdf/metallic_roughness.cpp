#include "render/bsdf/metallic_roughness.h"

#include <algorithm>
#include <cmath>

#include "render/bsdf/fresnel.h"
#include "render/sampling/warp.h"

namespace latent::render {

namespace {

constexpr float kCoatF0 = 0.04f;  // index 1.5

float alpha_of(float roughness) { return roughness * roughness; }

Microfacets facets_of(float alpha) {
    const float a = std::max(alpha, MetallicRoughness::kMinAlpha);
    return {a, a};
}

// D G / (4 |a.z| |b.z|), for the half vector m.
float facets_over_cosines(const Microfacets& facets, const Vec3f& a, const Vec3f& b, const Vec3f& m) {
    return facets.density(m) * facets.masking_shadowing(a, b) / (4 * std::abs(a.z * b.z));
}

}  // namespace

MetallicRoughness::MetallicRoughness(const Values<MetallicRoughness>& v)
    : MetallicRoughness(v.spectrum("base_color"),
                        {.metallic = v.number("metallic"),
                         .alpha = alpha_of(v.number("roughness")),
                         .f0 = v.number("f0"),
                         .f90 = v.number("f90"),
                         .coat = v.number("coat"),
                         .coat_alpha = alpha_of(v.number("coat_roughness"))},
                        v.find("specular_color")) {}

MetallicRoughness::MetallicRoughness(const SampledSpectrum& base, const Parameters& p, const SampledSpectrum* specular_color)
    : base_(&base),
      specular_color_(specular_color),
      brightest_(base.max()),
      metallic_(p.metallic),
      f0_(p.f0),
      f90_(p.f90),
      coat_(p.coat),
      facets_(facets_of(p.alpha)),
      coat_facets_(facets_of(p.coat_alpha)),
      metal_albedo_(brightest_, 1, facets_.alpha_x),
      albedo_(specular_color != nullptr ? p.f0 * specular_color->max() : p.f0, p.f90, facets_.alpha_x),
      min_albedo_(specular_color != nullptr ? p.f0 * std::ranges::min(specular_color->v) : p.f0, p.f90, facets_.alpha_x),
      coat_albedo_(kCoatF0, 1, coat_facets_.alpha_x) {}

void MetallicRoughness::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    const float mu = std::abs(w_camera.z), mu_light = std::abs(w_light.z);
    const float below =
        coat_ > 0 ? (1 - coat_ * coat_albedo_(mu)) * (1 - coat_ * coat_albedo_(mu_light)) : 1;  // what the coat passes, twice
    float times_base = (1 - metallic_) * kInvPi * (1 - albedo_(mu)) * (1 - albedo_(mu_light)) / std::max(1 - albedo_.mean(), 1e-6f),
          constant = 0;
    float coat = 0, rise = 0, d = 0;
    Vec3f m;
    if (half_vector(w_camera, w_light, 1, m)) {
        rise = schlick_rise(abs_dot(w_camera, m)), d = facets_over_cosines(facets_, w_camera, w_light, m);
        times_base += metallic_ * (1 - rise) * d;
        constant = (metallic_ * rise + (1 - metallic_) * (f0_ + (f90_ - f0_) * rise)) * d;
        if (coat_ > 0) coat = coat_ * (kCoatF0 + (1 - kCoatF0) * rise) * facets_over_cosines(coat_facets_, w_camera, w_light, m);
    }
    if (specular_color_ != nullptr) {  // body and facets differ with wavelength: E = f0 c e0 + e90
        const SchlickAlbedo e0(1, 0, facets_.alpha_x), e90(0, f90_, facets_.alpha_x);
        const float e = e0(mu), e_light = e0(mu_light), mean = e0.mean(), rest = 1 - e90(mu), rest_light = 1 - e90(mu_light),
                    rest_mean = 1 - e90.mean();
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            const float f0 = f0_ * specular_color_->v[i],
                        body = kInvPi * (rest - f0 * e) * (rest_light - f0 * e_light) / std::max(rest_mean - f0 * mean, 1e-6f),
                        dielectric = body * base_->v[i] + (f0 + (f90_ - f0) * rise) * d,
                        metal = (base_->v[i] + (1 - base_->v[i]) * rise) * d;
            value.v[i] *= (below * ((1 - metallic_) * dielectric + metallic_ * metal) + coat) * mu_light;
        }
        return;
    }
    times_base *= below * mu_light;
    constant = (constant * below + coat) * mu_light;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) value.v[i] *= times_base * base_->v[i] + constant;
}

MetallicRoughness::Lobes MetallicRoughness::lobes(const Vec3f& wo) const {
    const float mu = std::abs(wo.z), coat = coat_ > 0 ? coat_ * coat_albedo_(mu) : 0, e = albedo_(mu);
    const float facets = (1 - coat) * (metallic_ * metal_albedo_(mu) + (1 - metallic_) * e),
                diffuse = (1 - coat) * (1 - metallic_) * brightest_ * (1 - (specular_color_ != nullptr ? min_albedo_(mu) : e)),
                sum = coat + facets + diffuse;
    if (!(sum > 0)) return {0, 0};
    return {coat / sum, facets / sum};
}

float MetallicRoughness::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    const Lobes p = lobes(wo);
    float pdf = std::max(1 - p.coat - p.facets, 0.0f) * kInvPi * std::abs(wi.z);
    Vec3f m;
    if (!half_vector(wo, wi, 1, m)) return pdf;
    const float jacobian = 1 / (4 * abs_dot(wo, m));
    pdf += p.facets * facets_.visible_density(wo, m) * jacobian;
    if (p.coat > 0) pdf += p.coat * coat_facets_.visible_density(wo, m) * jacobian;
    return pdf;
}

bool MetallicRoughness::sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum&) const {
    const Lobes p = lobes(wo);
    if (u_lobe < p.coat + p.facets) {
        const Vec3f m = (u_lobe < p.coat ? coat_facets_ : facets_).sample_visible(wo, u, v);
        out.wi = m * (2 * dot(wo, m)) - wo;
    } else {
        out.wi = sample_cosine_hemisphere(u, v);
        if (wo.z < 0) out.wi.z = -out.wi.z;
    }
    return out.wi.z * wo.z > 0;
}

}  // namespace latent::render
