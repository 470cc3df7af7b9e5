#include "render/bsdf/diffuse.h"

#include <cmath>

#include "render/sampling/warp.h"

namespace latent::render {

void Diffuse::multiply_f_cos(const Vec3f&, const Vec3f& w_light, SampledSpectrum& value) const {
    const float s = kInvPi * std::abs(w_light.z);
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) value.v[i] *= reflectance_->v[i] * s;
}

float Diffuse::pdf_omega(const Vec3f&, const Vec3f& wi) const { return kInvPi * std::abs(wi.z); }

bool Diffuse::sample(const Vec3f& wo, float, float u, float v, ClosureSample& out, SampledSpectrum&) const {
    out.wi = sample_cosine_hemisphere(u, v);
    if (wo.z < 0) out.wi.z = -out.wi.z;
    return true;
}

}  // namespace latent::render
