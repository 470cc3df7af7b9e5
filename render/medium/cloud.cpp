#include "render/medium/cloud.h"

#include <algorithm>

#include "render/texture/noise.h"

namespace latent::render {

namespace {

// By differences over a hundredth, as pbrt-v4 takes them.
Vec3f noise_gradient(const Vec3f& p) {
    constexpr float kDelta = 0.01f;
    const float here = noise(p);
    return Vec3f{noise(p + Vec3f{kDelta, 0, 0}) - here, noise(p + Vec3f{0, kDelta, 0}) - here,
                 noise(p + Vec3f{0, 0, kDelta}) - here} /
           kDelta;
}

float cloud_density(const CloudVolume& volume, const Vec3f& p) {
    Vec3f q = p * static_cast<float>(volume.frequency);
    if (volume.wispiness > 0) {
        float weight = 0.05f * static_cast<float>(volume.wispiness), scale = 10;
        for (int i = 0; i < 2; ++i, weight *= 0.5f, scale *= 1.99f) q += noise_gradient(q * scale) * weight;
    }
    float sum = 0, weight = 0.5f, scale = 1;
    for (int i = 0; i < 5; ++i, weight *= 0.5f, scale *= 1.99f) sum += weight * noise(q * scale);
    const float billows = std::clamp((1 - p.y) * 4.5f * static_cast<float>(volume.density) * sum, 0.0f, 1.0f);
    return std::min(billows + 2 * std::max(0.0f, 0.5f - p.y), 1.0f);
}

// Noise has no bound within a cell that is worth its cost: the bound is that of the cloud.
MajorantGrid majorants_of(const CloudVolume& volume, const Affinef& medium_from_unit) {
    return {{16, 16, 16},
            [](const Vec3f&, const Vec3f&) { return 1.0f; },
            [&](const Vec3f& p) { return cloud_density(volume, medium_from_unit.point(p)); }};
}

}  // namespace

CloudMedium::CloudMedium(const PhaseFunction& phase, const Affined& medium_from_unit, const Affined& unit_from_world,
                         std::uint32_t sigma_t, std::uint32_t sigma_s, const CloudVolume& volume)
    : ScaledMedium(phase, unit_from_world, sigma_t, sigma_s, majorants_of(volume, Affinef(medium_from_unit))),
      medium_from_unit_(medium_from_unit),
      volume_(volume) {}

float CloudMedium::density(const Vec3f& p) const { return cloud_density(volume_, medium_from_unit_.point(p)); }

}  // namespace latent::render
