#include "render/light/uniform_infinite_light.h"

namespace latent::render {

UniformInfiniteLight::UniformInfiniteLight(const LightDescription& light, std::uint32_t spectrum, const SceneBall& ball)
    : emission_{spectrum, static_cast<float>(light.scale * (light.illuminance ? *light.illuminance / std::numbers::pi : 1))},
      ball_(ball) {}

bool UniformInfiniteLight::sample_point(const Vec3f& from, const Receiver& receiver, Uniform u, Uniform v, LightPoint& out) const {
    out = {.at = {}, .wi = {}, .distance = kInfinity, .pdf_omega = 0};
    if (receiver.n == Vec3f{}) {
        out.wi = sample_sphere(u, v);
    } else {
        const bool behind = receiver.both_sides && u.index(2) == 0;
        if (receiver.both_sides) u = u.within(2);
        out.wi = Frame::from_z(behind ? -receiver.n : receiver.n).to_world(sample_cosine_hemisphere(u, v));
    }
    out.pdf_omega = pdf_omega(from, receiver, {out.wi});
    return out.pdf_omega > 0;
}

float UniformInfiniteLight::pdf_omega(const Vec3f&, const Receiver& receiver, const LightHit& hit) const {
    return receiver.n == Vec3f{} ? kInv4Pi : kInvPi * abs_dot(receiver.n, hit.wi) * (receiver.both_sides ? 0.5f : 1);
}

void UniformInfiniteLight::sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const {
    out = ball_.sample_ray(sample_sphere(s, t), kInv4Pi, u, v);
}

}  // namespace latent::render
