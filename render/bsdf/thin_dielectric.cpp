#include "render/bsdf/thin_dielectric.h"

#include "render/bsdf/fresnel.h"

namespace latent::render {
namespace {

// All bounces between the two faces: F + (1 - F)^2 F / (1 - F^2).
float of_pane(float f) { return 2 * f / (1 + f); }

// The other side of the pane, for a direction that it would reflect.
Vec3f through_pane(const Vec3f& w) { return {w.x, w.y, -w.z}; }

}  // namespace

SampledSpectrum ThinDielectric::reflectance(float c) const {
    const bool is_filmed = film_.share > 0;
    if (!dispersive_ && !is_filmed) return SampledSpectrum(of_pane(fresnel_dielectric(c, eta_kept_)));
    const ThinFilm::Ray ray(film_, c);
    return spectrum_of([&](std::uint32_t i) {
        const float bare = fresnel_dielectric(c, (*eta_)[i]);
        if (!is_filmed) return of_pane(bare);
        return of_pane(bare + film_.share * (ray.reflectance((*eta_)[i], wavelengths_->lambda_nm[i]) - bare));
    });
}

float ThinDielectric::probability(float c) const {
    return film_.share > 0 ? mean_of(reflectance(c), wavelengths_->k) : of_pane(fresnel_dielectric(c, eta_kept_));
}

// R D G / (4 |cos cos|), and (1 - R) D G / (4 |cos cos|) for the direction that is mirrored by the pane.
void ThinDielectric::multiply_f_cos(const Vec3f& camera, const Vec3f& other, SampledSpectrum& value) const {
    const Vec3f w_camera = brushing_.to_facets(camera), w_light = brushing_.to_facets(other);
    const bool passes = w_camera.z * w_light.z < 0;
    const Vec3f light = passes ? through_pane(w_light) : w_light;
    Vec3f m;
    if (is_delta() || !half_vector(w_camera, light, 1, m)) {
        value = SampledSpectrum(0.0f);
        return;
    }
    const SampledSpectrum r = reflectance(abs_dot(w_camera, m));
    value *= passes ? spectrum_of([&](std::uint32_t i) { return 1 - r[i]; }) : r;
    value *= facets_.density(m) * facets_.masking_shadowing(w_camera, light) / (4 * std::abs(w_camera.z));
    if (passes && transmittance_ != nullptr) value *= *transmittance_;
}

float ThinDielectric::pdf_omega(const Vec3f& out, const Vec3f& in) const {
    const Vec3f wo = brushing_.to_facets(out), wi = brushing_.to_facets(in);
    const bool passes = wo.z * wi.z < 0;
    Vec3f m;
    if (is_delta() || !half_vector(wo, passes ? through_pane(wi) : wi, 1, m)) return 0;
    const float c = abs_dot(wo, m), r = probability(c);
    return (passes ? 1 - r : r) * facets_.visible_density(wo, m) / (4 * c);
}

// Reflection with its probability; else through the pane.
bool ThinDielectric::sample(const Vec3f& w, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const {
    if (!is_delta()) {
        const Vec3f wo = brushing_.to_facets(w), m = facets_.sample_visible(wo, u, v);
        out.wi = m * (2 * dot(wo, m)) - wo;
        if (!(out.wi.z * wo.z > 0)) return false;
        if (!(u_lobe < probability(abs_dot(wo, m)))) out.wi = through_pane(out.wi);
        out.wi = brushing_.from_facets(out.wi);
        return true;
    }
    const float c = std::abs(w.z), r = probability(c);
    const bool reflected = u_lobe < r;
    out.wi = reflected ? Vec3f{-w.x, -w.y, w.z} : -w;
    out.delta = true;
    out.probability = out.probability_reverse = reflected ? r : 1 - r;
    if (!reflected && transmittance_ != nullptr) weight *= *transmittance_;
    if (!dispersive_ && film_.share == 0) return true;
    const SampledSpectrum reflectances = reflectance(c);
    if (reflected) {
        weight *= reflectances;
        weight *= 1 / r;
    } else {
        weight *= spectrum_of([&](std::uint32_t i) { return (1 - reflectances[i]) / (1 - r); });
    }
    return true;
}

}  // namespace latent::render
