#include "render/light/distant_light.h"

namespace latent::render {

DistantLight::DistantLight(const LightDescription& light, std::uint32_t spectrum, const SceneBall& ball)
    : towards_(normalize(light.world_from_light.point(light.from) - light.world_from_light.point(light.to))),
      emission_{spectrum, static_cast<float>(light.scale * light.illuminance.value_or(1))},
      ball_(ball) {}

bool DistantLight::sample_point(const Vec3f&, const LightSampleContext&, Uniform, Uniform, LightPoint& out) const {
    out = {.at = {}, .wi = towards_, .distance = kInfinity, .pdf_omega = 1};
    return true;
}

void DistantLight::sample_ray(Uniform u, Uniform v, Uniform, Uniform, LightRay& out) const {
    out = ball_.sample_ray(towards_, 1, u, v);
}

}  // namespace latent::render
