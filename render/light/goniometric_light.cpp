#include "render/light/goniometric_light.h"

namespace latent::render {

GoniometricLight::GoniometricLight(const LightDescription& light, const EnvironmentMap& map, std::uint32_t spectrum)
    : source_{Vec3f(light.world_from_light.t)}, map_(&map), medium_(light.medium) {
    emission_ = {spectrum, static_cast<float>(light.scale * (light.power ? *light.power / extent() : 1))};
}

bool GoniometricLight::sample_point(const Vec3f& from, const LightSampleContext&, Uniform, Uniform, LightPoint& out) const {
    return source_.sample_point(from, out);
}

void GoniometricLight::sample_ray(Uniform, Uniform, Uniform s, Uniform t, LightRay& out) const {
    const Vec3f d = map_->sample(s, t);
    out = {.at = {source_.p, 0, {}}, .d = d, .pdf_position = 1, .pdf_direction = map_->pdf_omega(d), .medium = medium_};
}

}  // namespace latent::render
