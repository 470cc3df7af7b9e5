#include "render/light/lights.h"

#include "render/light/environment.h"

namespace latent::render {
namespace {

// 1 - cos of an angle below a right one, given its squared sine.
float one_minus_cos(float sin2) { return sin2 / (1 + std::sqrt(std::max(0.0f, 1 - sin2))); }

Vec3f sample_constant_sky(const Receiver& receiver, Uniform u, Uniform v) {
    if (receiver.n == Vec3f{}) return sample_sphere(u, v);
    const bool behind = receiver.both_sides && u.index(2) == 0;
    if (receiver.both_sides) u = u.within(2);
    return Frame::from_z(behind ? -receiver.n : receiver.n).to_world(sample_cosine_hemisphere(u, v));
}

}  // namespace

Lights::Lights() = default;
Lights::~Lights() = default;
Lights::Lights(Lights&&) noexcept = default;

float Lights::spot_profile(const Light& light, const Vec3f& d) const {
    const float h = one_minus_dot(d, light.n);
    if (light.outer == light.inner) return h <= light.outer ? 1 : 0;
    const float t = std::clamp((light.outer - h) / (light.outer - light.inner), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

bool Lights::sample_point(std::uint32_t i, const Vec3f& from, const Receiver& receiver, Uniform u, Uniform v,
                          LightPoint& out) const {
    const Light& light = lights_[i];
    out.falloff = 1;
    switch (light.kind) {
        case Light::Kind::kTriangle: {
            const Vec2f b = sample_triangle(u, v);
            const Vec3f p = light.p + light.e1 * b.x + light.e2 * b.y;
            out.anchor = {p, 4e-7f * (max_abs(light.p) + max_abs(light.e1) + max_abs(light.e2)), light.n};
            break;
        }
        case Light::Kind::kSphere: {
            const Vec3f axis = light.p - from;
            const float d2 = length_squared(axis), r2 = light.radius * light.radius;
            Vec3f n;
            if (d2 > r2 * 1.0002f) {
                const float sin2_max = r2 / d2;
                const float h = one_minus_cos(sin2_max) * u, cosine = 1 - h;
                const float sin2 = h * (1 + cosine);
                // The angle at the centre between -axis and the point where the drawn direction meets the sphere [PBRT4 6.2.4].
                const float cos_alpha = sin2 / std::sqrt(sin2_max) + cosine * std::sqrt(std::max(0.0f, 1 - sin2 / sin2_max));
                n = Frame::from_z(-axis / std::sqrt(d2)).to_world(direction_at(std::min(cos_alpha, 1.0f), v));
            } else {
                n = sample_sphere(u, v);
            }
            out.anchor = {light.p + n * light.radius, 4e-7f * (max_abs(light.p) + light.radius), light.inward ? -n : n};
            break;
        }
        case Light::Kind::kPoint:
        case Light::Kind::kSpot:
            out.anchor = {light.p, 0, {}};
            break;
        default:
            out.anchor = {};
            out.distance = kInfinity;
            if (light.kind == Light::Kind::kDistant) {
                out.wi = light.n;
                out.pdf_omega = 1;
                return true;
            }
            out.wi = light.kind == Light::Kind::kImage ? light.environment->sample(u, v) : sample_constant_sky(receiver, u, v);
            out.pdf_omega = pdf_of_direction(i, out.wi, receiver);
            return out.pdf_omega > 0;
    }
    const Vec3f to = out.anchor.p - from;
    const float d2 = length_squared(to);
    if (!(d2 > 0)) return false;
    out.distance = std::sqrt(d2);
    out.wi = to / out.distance;
    if (light.is_delta()) {
        out.pdf_omega = 1;
        out.falloff = 1 / d2;
        if (light.kind == Light::Kind::kSpot) out.falloff *= spot_profile(light, -out.wi);
        return out.falloff > 0;
    }
    if (!light.two_sided && dot(out.wi, out.anchor.ng) >= 0) return false;
    out.pdf_omega = pdf_of_point(i, from, out.anchor.p, out.anchor.ng);
    return out.pdf_omega > 0;
}

float Lights::pdf_of_point(std::uint32_t i, const Vec3f& from, const Vec3f& p, const Vec3f& ng) const {
    const Light& light = lights_[i];
    if (light.kind == Light::Kind::kSphere) {
        const float d2 = length_squared(light.p - from), r2 = light.radius * light.radius;
        if (d2 > r2 * 1.0002f) return light.inward ? 0 : pdf_of_cone(one_minus_cos(r2 / d2));
    }
    const Vec3f to = p - from;
    const float d2 = length_squared(to), cosine = abs_dot(to, ng) / std::sqrt(d2);
    return cosine > 0 ? d2 / (cosine * light.area) : 0;
}

float Lights::pdf_of_direction(std::uint32_t i, const Vec3f& wi, const Receiver& receiver) const {
    const Light& light = lights_[i];
    if (light.kind == Light::Kind::kImage) return light.environment->pdf_omega(wi);
    if (light.kind != Light::Kind::kConstant) return 0;
    return receiver.n == Vec3f{} ? kInv4Pi : kInvPi * abs_dot(receiver.n, wi) * (receiver.both_sides ? 0.5f : 1);
}

void Lights::sample_ray(std::uint32_t i, Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const {
    const Light& light = lights_[i];
    out.cosine = 1;
    out.profile = 1;
    out.medium = light.outside_medium;
    out.pdf_position = pdf_of_position(i);
    switch (light.kind) {
        case Light::Kind::kTriangle:
        case Light::Kind::kSphere: {
            Vec3f p, n;
            if (light.kind == Light::Kind::kTriangle) {
                const Vec2f b = sample_triangle(u, v);
                p = light.p + light.e1 * b.x + light.e2 * b.y;
                n = light.n;
            } else {
                const Vec3f outwards = sample_sphere(u, v);
                p = light.p + outwards * light.radius;
                n = light.inward ? -outwards : outwards;
            }
            const float size = max_abs(light.p) + max_abs(light.e1) + max_abs(light.e2) + light.radius;
            out.anchor = {p, 4e-7f * size, n};
            const bool back = light.two_sided && s.index(2) == 1;
            if (light.two_sided) s = s.within(2);
            Vec3f local = sample_cosine_hemisphere(s, t);
            local.z = std::max(local.z, 1e-6f);
            out.d = normalize(Frame::from_z(back ? -n : n).to_world(local));
            out.cosine = abs_dot(out.d, n);
            if (back) out.medium = light.inside_medium;
            out.pdf_direction = pdf_of_emission(i, n, out.d);
            return;
        }
        case Light::Kind::kPoint:
        case Light::Kind::kSpot:
            out.anchor = {light.p, 0, {}};
            out.d = light.kind == Light::Kind::kPoint ? sample_sphere(s, t)
                                                      : Frame::from_z(light.n).to_world(sample_cone(light.outer, s, t));
            if (light.kind == Light::Kind::kSpot) out.profile = spot_profile(light, out.d);
            out.pdf_direction = pdf_of_emission(i, {}, out.d);
            return;
        default: {
            const Vec3f towards = light.kind == Light::Kind::kDistant    ? light.n
                                  : light.kind == Light::Kind::kConstant ? sample_sphere(s, t)
                                                                         : light.environment->sample(s, t);
            const Vec2f d = sample_disk(u, v);
            const Frame frame = Frame::from_z(towards);
            out.anchor = {center_ + (frame.x * d.x + frame.y * d.y + towards) * radius_, 0, {}};
            out.d = -towards;
            out.pdf_direction = light.kind == Light::Kind::kDistant ? 1 : pdf_of_direction(i, towards, {});
            return;
        }
    }
}

float Lights::pdf_of_emission(std::uint32_t i, const Vec3f& ng, const Vec3f& d) const {
    const Light& light = lights_[i];
    switch (light.kind) {
        case Light::Kind::kTriangle:
        case Light::Kind::kSphere: {
            const float c = dot(ng, d);
            return light.two_sided ? 0.5f * kInvPi * std::abs(c) : kInvPi * std::max(0.0f, c);
        }
        case Light::Kind::kPoint:
            return kInv4Pi;
        case Light::Kind::kSpot:
            return one_minus_dot(d, light.n) > light.outer ? 0 : pdf_of_cone(light.outer);
        case Light::Kind::kDistant:
            return 0;
        default:
            return pdf_of_direction(i, -d, {});
    }
}

float Lights::pdf_of_position(std::uint32_t i) const {
    const Light& light = lights_[i];
    if (light.has_area()) return 1 / light.area;
    return light.is_infinite() ? 1 / (kPi * radius_ * radius_) : 1;
}

void Lights::multiply_emission(std::uint32_t i, const Vec3f& ng, const Vec3f& d, SampledSpectra& spectra, Batch& value) const {
    const Light& light = lights_[i];
    if (light.has_area() && !light.two_sided && dot(ng, d) <= 0) {
        value = Batch(0.0f);
        return;
    }
    const Batch& s = spectra[light.spectrum];
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) value.v[lane] *= s.v[lane] * light.scale;
    if (light.environment) light.environment->multiply(-d, spectra, value);
}

}  // namespace latent::render
