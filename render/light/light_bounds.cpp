#include "render/light/light_bounds.h"

#include "render/math/elementary.h"

namespace latent::render {
namespace {

constexpr double kSphere = 1 / (4 * std::numbers::pi);  // concentration of light in all directions

float turns_between(const Vec3d& a, const Vec3d& b) {
    return angle_in_turns(static_cast<float>(dot(a, b)), static_cast<float>(length(cross(a, b))));
}

// Rounding of an angle.
constexpr float kTurnsError = 1e-6f;

// The smallest cone about the cones of a and b.
void join_cones(const LightBounds& a, const LightBounds& b, LightBounds& out) {
    const bool whole = a.spread >= 0.5f || b.spread >= 0.5f;
    const Vec3d turned = out.both_sides ? face_forward(b.axis, a.axis) : b.axis;
    const float between = turns_between(a.axis, turned);
    if (!whole && between + b.spread <= a.spread) return out.point(a.axis, a.spread, out.falloff);
    if (!whole && between + a.spread <= b.spread) return out.point(b.axis, b.spread, out.falloff);
    const float spread = (a.spread + between + b.spread) / 2 + kTurnsError;
    const SinCos sc = sincos_turns(spread - a.spread);  // how far the axis turns from a to b
    const Vec3d across = turned - a.axis * dot(a.axis, turned);
    if (whole || !(spread < 0.5f) || !(length_squared(across) > 0)) return out.point(a.axis, 0.5f, out.falloff);
    const Vec3d axis = normalize(a.axis * static_cast<double>(sc.cos) + normalize(across) * static_cast<double>(sc.sin));
    out.point(axis, std::max(turns_between(axis, a.axis) + a.spread, turns_between(axis, turned) + b.spread) + kTurnsError,
              out.falloff);
}

}  // namespace

LightBounds LightBounds::from_ball(const Vec3d& center, double radius) {
    LightBounds out;
    out.box.add(center - Vec3d(radius, radius, radius));
    out.box.add(center + Vec3d(radius, radius, radius));
    out.center = center;
    out.radius = radius;
    out.concentration = kSphere;
    return out;
}

LightBounds LightBounds::from_box(const Box& box) {
    LightBounds out;
    out.box = box;
    out.center = box.middle();
    out.radius = 0.5 * length(box.high - box.low);
    out.concentration = kSphere;
    return out;
}

double LightBounds::measure() const {
    const float lit = std::min(spread + falloff, 0.5f);
    const SinCos o = sincos_turns(spread), far = sincos_turns(spread - 2 * lit);
    const double full = 2 * std::numbers::pi * (1 - static_cast<double>(o.cos));
    const double angles = 4 * std::numbers::pi * static_cast<double>(lit - spread);  // 2 (lit - spread) in radians
    const double fading = std::numbers::pi / 2 * (angles * static_cast<double>(o.sin) + static_cast<double>(o.cos - far.cos));
    return intensity * (full + fading) * length_squared(box.high - box.low);
}

LightBounds operator+(const LightBounds& a, const LightBounds& b) {
    LightBounds out = a;
    out.box.add(b.box.low);
    out.box.add(b.box.high);
    out.center = out.box.middle();
    out.radius = std::min(0.5 * length(out.box.high - out.box.low),
                          std::max(length(out.center - a.center) + a.radius, length(out.center - b.center) + b.radius));
    out.both_sides = a.both_sides || b.both_sides;
    out.falloff = std::max(a.falloff, b.falloff);
    join_cones(a, b, out);
    out.intensity = a.intensity + b.intensity;
    return out;
}

}  // namespace latent::render
