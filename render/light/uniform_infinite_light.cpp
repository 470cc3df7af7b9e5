#include "render/light/uniform_infinite_light.h"

namespace latent::render {

UniformInfiniteLight::UniformInfiniteLight(const LightDescription& light, std::uint32_t spectrum, const SceneBall& ball)
    : emission_{spectrum, static_cast<float>(light.scale * (light.illuminance ? *light.illuminance / std::numbers::pi : 1))},
      ball_(ball) {}

bool UniformInfiniteLight::sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v,
                                        LightPoint& out) const {
    out = {.at = {}, .wi = {}, .distance = kInfinity, .pdf_omega = 0};
    if (context.n == Vec3f{}) {
        out.wi = sample_sphere(u, v);
    } else {
        const bool behind = context.both_sides && u.index(2) == 0;
        if (context.both_sides) u = u.within(2);
        out.wi = Frame::from_z(behind ? -context.n : context.n).to_world(sample_cosine_hemisphere(u, v));
    }
    out.pdf_omega = pdf_omega(from, context, {out.wi});
    return out.pdf_omega > 0;
}

float UniformInfiniteLight::pdf_omega(const Vec3f&, const LightSampleContext& context, const LightHit& hit) const {
    return context.n == Vec3f{} ? kInv4Pi : kInvPi * abs_dot(context.n, hit.wi) * (context.both_sides ? 0.5f : 1);
}

void UniformInfiniteLight::sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const {
    out = ball_.sample_ray(sample_sphere(s, t), kInv4Pi, u, v);
}

}  // namespace latent::render
