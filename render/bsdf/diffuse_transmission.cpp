#include "render/bsdf/diffuse_transmission.h"

#include <cmath>

#include "render/sampling/warp.h"

namespace latent::render {

DiffuseTransmission::DiffuseTransmission(const SampledSpectrum& reflectance, const SampledSpectrum& transmittance)
    : reflectance_(&reflectance), transmittance_(&transmittance) {
    const float r = reflectance.max(), t = transmittance.max();
    reflection_probability_ = r + t > 0 ? r / (r + t) : 1;
}

void DiffuseTransmission::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    const SampledSpectrum& share = w_camera.z * w_light.z > 0 ? *reflectance_ : *transmittance_;
    const float s = kInvPi * std::abs(w_light.z);
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) value.v[i] *= share.v[i] * s;
}

float DiffuseTransmission::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    return (wo.z * wi.z > 0 ? reflection_probability_ : 1 - reflection_probability_) * kInvPi * std::abs(wi.z);
}

bool DiffuseTransmission::sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum&) const {
    out.wi = sample_cosine_hemisphere(u, v);
    if ((u_lobe < reflection_probability_) != (wo.z > 0)) out.wi.z = -out.wi.z;
    return true;
}

}  // namespace latent::render
