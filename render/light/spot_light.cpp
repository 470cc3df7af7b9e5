#include "render/light/spot_light.h"

namespace latent::render {
namespace {

double one_minus_cos(double degrees) {
    const double s = std::sin(degrees * std::numbers::pi / 360);
    return 2 * s * s;
}

}  // namespace

SpotLight::SpotLight(const LightDescription& light, std::uint32_t spectrum) : medium_(light.medium) {
    const Vec3d from = light.world_from_light.point(light.from), to = light.world_from_light.point(light.to);
    const double outer = one_minus_cos(light.cone_degrees), inner = one_minus_cos(light.cone_degrees - light.cone_delta_degrees);
    source_ = {Vec3f(from), Vec3f(normalize(to - from)), static_cast<float>(outer)};
    inner_ = static_cast<float>(inner);
    solid_angle_ = std::numbers::pi * (inner + outer);
    emission_ = {spectrum, static_cast<float>(light.scale * (light.power ? *light.power / solid_angle_ : 1))};
}

float SpotLight::profile(const Vec3f& d) const {
    const float h = one_minus_dot(d, source_.axis);
    if (source_.outer == inner_) return h <= source_.outer ? 1 : 0;
    const float t = std::clamp((source_.outer - h) / (source_.outer - inner_), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

bool SpotLight::sample_point(const Vec3f& from, const LightSampleContext&, Uniform, Uniform, LightPoint& out) const {
    if (!source_.sample_point(from, out)) return false;
    out.falloff *= profile(-out.wi);
    return out.falloff > 0;
}

void SpotLight::sample_ray(Uniform, Uniform, Uniform s, Uniform t, LightRay& out) const {
    const Vec3f d = Frame::from_z(source_.axis).to_world(sample_cone(source_.outer, s, t));
    out = {.at = {source_.p, 0, {}},
           .d = d,
           .pdf_position = 1,
           .pdf_direction = pdf_direction({}, d),
           .profile = profile(d),
           .medium = medium_};
}

}  // namespace latent::render
