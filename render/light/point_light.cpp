#include "render/light/point_light.h"

namespace latent::render {

PointLight::PointLight(const LightDescription& light, std::uint32_t spectrum)
    : source_{Vec3f(light.world_from_light.point(light.from))}, medium_(light.medium) {
    const double per_power = light.power ? *light.power / (4 * std::numbers::pi) : 1;
    emission_ = {spectrum, static_cast<float>(light.scale * per_power)};
}

bool PointLight::sample_point(const Vec3f& from, const LightSampleContext&, Uniform, Uniform, LightPoint& out) const {
    return source_.sample_point(from, out);
}

void PointLight::sample_ray(Uniform, Uniform, Uniform s, Uniform t, LightRay& out) const {
    out = {.at = {source_.p, 0, {}}, .d = sample_sphere(s, t), .pdf_position = 1, .pdf_direction = kInv4Pi, .medium = medium_};
}

}  // namespace latent::render
