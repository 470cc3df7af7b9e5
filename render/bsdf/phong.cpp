#include "render/bsdf/phong.h"

#include <cmath>

#include "render/math/elementary.h"
#include "render/sampling/warp.h"

namespace latent::render {
namespace {

Vec3f middle_of_lobe(const Vec3f& w, bool retro) { return retro ? w : Vec3f{-w.x, -w.y, w.z}; }

// max(0, cos a)^n, by 1 - cos a: sharp lobes keep their digits.
float lobe(const Vec3f& a, const Vec3f& b, float n, bool retro) {
    const float h = one_minus_dot(middle_of_lobe(a, retro), b);
    return h < 1 ? exp_nonpositive(n * log_one_minus(h)) : 0;
}

}  // namespace

Phong::Phong(const SampledSpectrum& diffuse, const SampledSpectrum& specular, float exponent, bool retro)
    : diffuse_(&diffuse), specular_(&specular), exponent_(exponent), retro_(retro) {
    const float d = diffuse.max(), s = specular.max();
    specular_probability_ = s > 0 ? s / (d + s) : 0;
}

void Phong::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    const float c = std::abs(w_light.z), d = kInvPi * c;
    const float s = (exponent_ + 2) * 0.5f * kInvPi * lobe(w_camera, w_light, exponent_, retro_) * c;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) value.v[i] *= diffuse_->v[i] * d + specular_->v[i] * s;
}

float Phong::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    const float diffuse = kInvPi * std::abs(wi.z), specular = (exponent_ + 1) * 0.5f * kInvPi * lobe(wo, wi, exponent_, retro_);
    return (1 - specular_probability_) * diffuse + specular_probability_ * specular;
}

bool Phong::sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum&) const {
    if (u_lobe < specular_probability_) {  // cos a = u^(1 / (n + 1))
        const float c = exp_nonpositive(log_one_minus(u) / (exponent_ + 1));
        out.wi = Frame::from_z(middle_of_lobe(wo, retro_)).to_world(direction_at(c, v));
    } else {
        out.wi = sample_cosine_hemisphere(u, v);
        if (wo.z < 0) out.wi.z = -out.wi.z;
    }
    return out.wi.z * wo.z > 0;
}

}  // namespace latent::render
