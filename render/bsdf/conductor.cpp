#include "render/bsdf/conductor.h"

namespace latent::render {

void Conductor::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    Vec3f m;
    if (!half_vector(w_camera, w_light, 1, m)) {
        value = SampledSpectrum(0.0f);
        return;
    }
    value *= fresnel_conductor(abs_dot(w_camera, m), *eta_, *k_);
    value *= facets_.density(m) * facets_.masking_shadowing(w_camera, w_light) / (4 * std::abs(w_camera.z));
}

float Conductor::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    Vec3f m;
    return half_vector(wo, wi, 1, m) ? facets_.visible_density(wo, m) / (4 * abs_dot(wo, m)) : 0;
}

bool Conductor::sample(const Vec3f& wo, float, float u, float v, ClosureSample& out, SampledSpectrum& weight) const {
    if (is_delta()) {
        out.wi = {-wo.x, -wo.y, wo.z};
        out.delta = true;
        out.probability = out.probability_reverse = 1;
        weight *= fresnel_conductor(std::abs(wo.z), *eta_, *k_);
        return true;
    }
    const Vec3f m = facets_.sample_visible(wo, u, v);
    out.wi = m * (2 * dot(wo, m)) - wo;
    return out.wi.z * wo.z > 0;
}

}  // namespace latent::render
