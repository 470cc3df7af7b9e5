#include "render/light/image_infinite_light.h"

namespace latent::render {

ImageInfiniteLight::ImageInfiniteLight(const LightDescription& light, const EnvironmentMap& map, std::uint32_t spectrum,
                                       const SceneBall& ball)
    : map_(&map),
      emission_{spectrum, static_cast<float>(light.scale * (light.illuminance ? *light.illuminance / map.upper_illuminance() : 1))},
      ball_(ball) {}

bool ImageInfiniteLight::sample_point(const Vec3f&, const LightSampleContext&, Uniform u, Uniform v, LightPoint& out) const {
    const Vec3f wi = map_->sample(u, v);
    out = {.at = {}, .wi = wi, .distance = kInfinity, .pdf_omega = map_->pdf_omega(wi)};
    return out.pdf_omega > 0;
}

void ImageInfiniteLight::sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const {
    const Vec3f towards = map_->sample(s, t);
    out = ball_.sample_ray(towards, map_->pdf_omega(towards), u, v);
}

}  // namespace latent::render
