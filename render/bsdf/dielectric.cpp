#include "render/bsdf/dielectric.h"

#include <algorithm>
#include <cmath>

#include "render/bsdf/fresnel.h"
#include "render/sampling/warp.h"

namespace latent::render {
namespace {

// Index of the side that w does not lie on over that of its side.
float across(const Vec3f& w, float eta) { return w.z > 0 ? eta : 1 / eta; }

}  // namespace

float Dielectric::reflectance(const Vec3f& w, float c, std::uint32_t lane) const {
    const float eta = across(w, (*eta_)[lane]), bare = fresnel_dielectric(c, eta);
    if (film_.share == 0 || bare == 1) return bare;
    const float c_air = w.z > 0 ? c : std::sqrt(std::max(0.0f, 1 - (1 - c * c) / (eta * eta)));
    const float filmed = ThinFilm::Ray(film_, c_air).reflectance((*eta_)[lane], wavelengths_->lambda_nm[lane]);
    return bare + film_.share * (filmed - bare);
}

SampledSpectrum Dielectric::reflectance(const Vec3f& w, float c) const {
    if (!dispersive_ && film_.share == 0) return SampledSpectrum(reflectance(w, c, kept_));
    return spectrum_of([&](std::uint32_t i) { return reflectance(w, c, i); });
}

// At the kept wavelength, if light is dispersed; a film may reflect nothing there, but much elsewhere.
float Dielectric::probability(const Vec3f& w, float c) const {
    if (dispersive_ || film_.share == 0) return reflectance(w, c, kept_);
    return mean_of(reflectance(w, c), wavelengths_->k);
}

// Reflection F D G / (4 |cos cos|); transmission (1 - F) D G |camera.m light.m| / (|cos cos| (light.m + camera.m / eta)^2 eta^2),
// eta the index on light's side over that on the camera's [WMLT07]; the last factor is the compression of radiance.
void Dielectric::multiply_once(const Vec3f& camera, const Vec3f& light, SampledSpectrum& value) const {
    const Vec3f w_camera = brushing_.to_facets(camera), w_light = brushing_.to_facets(light);
    const bool same_side = w_camera.z * w_light.z > 0;
    const float eta = same_side ? 1 : across(w_camera, eta_kept_);
    Vec3f m;
    if (!half_vector(w_camera, w_light, eta, m)) {
        value = SampledSpectrum(0.0f);
        return;
    }
    const float dg = facets_.density(m) * facets_.masking_shadowing(w_camera, w_light);
    const float cosine = abs_dot(w_camera, m);
    if (same_side) {
        value *= reflectance(w_camera, cosine);
        value *= dg / (4 * std::abs(w_camera.z));
        if (tint_ != nullptr) value *= *tint_;
    } else {
        if (film_.share > 0) {
            const SampledSpectrum f = reflectance(w_camera, cosine);
            value *= spectrum_of([&](std::uint32_t i) { return 1 - f.v[i]; });
        }
        const float t = film_.share > 0 ? 1 : 1 - fresnel_dielectric(cosine, eta);
        value *= t * dg * cosine * refraction_jacobian(w_camera, w_light, m, eta) / (std::abs(w_camera.z) * eta * eta);
        if (transmittance_ != nullptr) value *= *transmittance_;
    }
}

void Dielectric::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    SampledSpectrum further = value;
    multiply_once(w_camera, w_light, value);
    if (!multiscatter_) return;
    const bool same_side = w_camera.z * w_light.z > 0;
    const float eta = same_side ? 1 : across(w_camera, eta_kept_);
    further *= lost().f_cos(w_camera, w_light) / (eta * eta);
    if (const SampledSpectrum* color = same_side ? tint_ : transmittance_) further *= *color;
    value += further;
}

float Dielectric::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    if (!multiscatter_) return pdf_once(wo, wi);
    const LostInGlass::Shares lost = this->lost()(wo);
    return (1 - lost.sum()) * pdf_once(wo, wi) + lost.towards(wo.z * wi.z > 0) * kInvPi * std::abs(wi.z);
}

float Dielectric::pdf_once(const Vec3f& out, const Vec3f& in) const {
    const Vec3f wo = brushing_.to_facets(out), wi = brushing_.to_facets(in);
    const bool same_side = wo.z * wi.z > 0;
    const float eta = across(wo, eta_kept_);
    Vec3f m;
    if (!half_vector(wo, wi, same_side ? 1 : eta, m)) return 0;
    const float f = probability(wo, abs_dot(wo, m));
    const float d = facets_.visible_density(wo, m);
    return same_side ? f * d / (4 * abs_dot(wo, m)) : (1 - f) * d * refraction_jacobian(wo, wi, m, eta);
}

// Reflection with probability F, refraction else.
bool Dielectric::sample(const Vec3f& w, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const {
    if (is_delta()) return sample_smooth(w, u_lobe, out, weight);
    if (multiscatter_) {
        const LostInGlass::Shares lost = this->lost()(w);
        if (u_lobe < lost.sum()) {
            const bool reflected = u_lobe < lost.reflected;
            out.wi = sample_cosine_hemisphere(u, v);
            if (reflected != (w.z > 0)) out.wi.z = -out.wi.z;
            if (!reflected) out.eta2 = across(w, eta_kept_) * across(w, eta_kept_);
            return out.wi.z != 0;
        }
        u_lobe = std::min((u_lobe - lost.sum()) / (1 - lost.sum()), 1 - 0x1p-24f);
    }
    const Vec3f wo = brushing_.to_facets(w);
    const Vec3f m = facets_.sample_visible(wo, u, v);
    const float eta = across(wo, eta_kept_);
    const bool reflected = u_lobe < probability(wo, abs_dot(wo, m));
    if (reflected) {
        out.wi = m * (2 * dot(wo, m)) - wo;
    } else if (!refract(wo, face_forward(m, wo), eta, out.wi)) {
        return false;
    }
    if (!reflected) out.eta2 = eta * eta;
    out.wi = brushing_.from_facets(out.wi);
    return reflected == (out.wi.z * wo.z > 0);
}

bool Dielectric::sample_smooth(const Vec3f& wo, float u_lobe, ClosureSample& out, SampledSpectrum& weight) const {
    const float c = std::abs(wo.z), eta = across(wo, eta_kept_), f = probability(wo, c);
    out.delta = true;
    if (u_lobe < f) {
        out.wi = {-wo.x, -wo.y, wo.z};
        out.probability = out.probability_reverse = f;
        if (dispersive_ || film_.share > 0) {
            weight *= reflectance(wo, c);
            weight *= 1 / f;
        }
        if (tint_ != nullptr) weight *= *tint_;
        return true;
    }
    if (!refract(wo, Vec3f{0, 0, wo.z > 0 ? 1.0f : -1.0f}, eta, out.wi)) return false;
    if (film_.share > 0) {
        const SampledSpectrum reflected = reflectance(wo, c);
        weight *= spectrum_of([&](std::uint32_t i) { return (1 - reflected.v[i]) / (1 - f); });
    }
    if (transmittance_ != nullptr) weight *= *transmittance_;
    out.eta2 = eta * eta;
    out.probability = 1 - f;
    out.probability_reverse = (1 - f) * c / (std::abs(out.wi.z) * out.eta2);  // per solid angle of its own side
    return true;
}

}  // namespace latent::render
