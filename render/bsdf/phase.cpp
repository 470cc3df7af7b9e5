#include "render/bsdf/phase.h"

#include <algorithm>
#include <cmath>

#include "render/sampling/warp.h"

namespace latent::render {

float PhaseFunction::operator()(const Vec3f& wo, const Vec3f& wi) const {
    const float d = 1 + g * g + 2 * g * dot(wo, wi);
    return kInv4Pi * (1 - g * g) / (d * std::sqrt(std::max(0.0f, d)));
}

// The inverse of the cumulative distribution in the cosine; isotropic where g would divide by nothing.
Vec3f PhaseFunction::sample(const Vec3f& wo, float u, float v) const {
    const float t = (1 - g * g) / (1 + g - 2 * g * u);
    const float c = std::abs(g) < 1e-3f ? 1 - 2 * u : -(1 + g * g - t * t) / (2 * g);
    return Frame::from_z(wo).to_world(direction_at(std::clamp(c, -1.0f, 1.0f), v));
}

float Phase::mixed_pdf(const Vec3f& wo, const Vec3f& wi) const {
    float sum = 0;
    for (std::uint32_t i = 0; i < mixture->count; ++i) sum += mixture->parts[i].mean * mixture->parts[i].phase(wo, wi);
    return sum;
}

void Phase::multiply_mixed(const Vec3f& wo, const Vec3f& wi, SampledSpectrum& value) const {
    SampledSpectrum sum(0.0f);
    for (std::uint32_t i = 0; i < mixture->count; ++i) sum += *mixture->parts[i].share * mixture->parts[i].phase(wo, wi);
    value *= sum;
}

const PhaseFunction& Phase::part(float u) const {
    std::uint32_t i = 0;
    for (; i + 1 < mixture->count && u >= mixture->parts[i].mean; ++i) u -= mixture->parts[i].mean;
    return mixture->parts[i].phase;
}

}  // namespace latent::render
