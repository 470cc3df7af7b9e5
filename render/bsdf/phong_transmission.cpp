#include "render/bsdf/phong_transmission.h"

#include <cmath>

#include "render/bsdf/fresnel.h"
#include "render/math/elementary.h"
#include "render/sampling/warp.h"

namespace latent::render {
namespace {

constexpr Vec3f kBefore{0, 0, 1}, kBehind{0, 0, -1};

}  // namespace

PhongTransmission::PhongTransmission(const SampledSpectrum& diffuse, const SampledSpectrum& specular, float exponent, float eta)
    : diffuse_(&diffuse), specular_(&specular), exponent_(exponent), eta_(eta) {
    const float d = diffuse.max() * std::min(1.0f, eta * eta), s = specular.max();
    specular_probability_ = s > 0 ? s / (d + s) : 0;
}

// By 1 - cos a: sharp lobes keep their digits.
PhongTransmission::Lobe PhongTransmission::lobe(const Vec3f& a, const Vec3f& b) const {
    const Vec3f &before = a.z > 0 ? a : b, &behind = a.z > 0 ? b : a;
    Vec3f refracted;
    if (!refract(before, kBefore, eta_, refracted)) return {0, 0};
    const float h = one_minus_dot(refracted, behind);
    return {h < 1 ? exp_nonpositive(exponent_ * log_one_minus(h)) : 0, before.z / (eta_ * eta_ * -refracted.z)};
}

void PhongTransmission::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    if (w_camera.z * w_light.z >= 0) {
        value = SampledSpectrum(0.0f);
        return;
    }
    const float eta2 = eta_ * eta_, c = std::abs(w_light.z) / (w_camera.z > 0 ? eta2 : 1);
    const float d = kInvPi * std::min(1.0f, eta2) * c, s = (exponent_ + 2) * 0.5f * kInvPi * lobe(w_camera, w_light).power * c;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) value.v[i] *= diffuse_->v[i] * d + specular_->v[i] * s;
}

float PhongTransmission::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    if (wo.z * wi.z >= 0) return 0;
    const Lobe l = lobe(wo, wi);
    const float specular = (exponent_ + 1) * 0.5f * kInvPi * l.power * (wo.z > 0 ? 1 : l.stretch);
    return (1 - specular_probability_) * kInvPi * std::abs(wi.z) + specular_probability_ * specular;
}

bool PhongTransmission::sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum&) const {
    out.eta2 = wo.z > 0 ? eta_ * eta_ : 1 / (eta_ * eta_);
    if (u_lobe >= specular_probability_) {
        out.wi = sample_cosine_hemisphere(u, v);
        if (wo.z > 0) out.wi.z = -out.wi.z;
        return out.wi.z * wo.z < 0;
    }
    Vec3f middle = wo;  // middle of the lobe, behind
    if (wo.z > 0 && !refract(wo, kBefore, eta_, middle)) return false;
    const float c = exp_nonpositive(log_one_minus(u) / (exponent_ + 1));  // cos a = u^(1 / (n + 1))
    const Vec3f behind = Frame::from_z(middle).to_world(direction_at(c, v));
    if (!(behind.z < 0)) return false;
    out.wi = behind;
    return wo.z > 0 || (refract(behind, kBehind, 1 / eta_, out.wi) && out.wi.z > 0);
}

}  // namespace latent::render
