// render/sampling/warp.h: uniform numbers to points and directions, with the density of each. docs/rendering.md.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/math/elementary.h"
#include "render/math/vec.h"

namespace latent::render {

inline constexpr float kInvPi = 1 / kPi;
inline constexpr float kInv4Pi = 1 / (4 * kPi);

// Unit disk, uniform: density 1 / pi. Concentric, so that neighbours stay neighbours [ShirleyChiu97].
inline Vec2f sample_disk(float u, float v) {
    const float x = 2 * u - 1, y = 2 * v - 1;
    if (x == 0 && y == 0) return {0, 0};
    const bool wide = std::abs(x) > std::abs(y);
    const float r = wide ? x : y;
    const SinCos a = sincos_turns(wide ? y / x * 0.125f : 0.25f - x / y * 0.125f);
    return {r * a.cos, r * a.sin};
}
// Hemisphere about z: density cos / pi.
inline Vec3f sample_cosine_hemisphere(float u, float v) {
    const Vec2f d = sample_disk(u, v);
    return {d.x, d.y, std::sqrt(std::max(0.0f, 1 - d.x * d.x - d.y * d.y))};
}
// Directions at cosine c about z, turned by `turns`.
inline Vec3f direction_at(float c, float turns) {
    const float s = std::sqrt(std::max(0.0f, 1 - c * c));
    const SinCos a = sincos_turns(turns);
    return {s * a.cos, s * a.sin, c};
}
// The same, given 1 - c: near z as exact as that.
inline Vec3f direction_beside(float one_minus_c, float turns) {
    const float s = std::sqrt(one_minus_c * (2 - one_minus_c));
    const SinCos a = sincos_turns(turns);
    return {s * a.cos, s * a.sin, 1 - one_minus_c};
}
// Sphere: density 1 / (4 pi).
inline Vec3f sample_sphere(float u, float v) { return direction_beside(2 * u, v); }
// Cone about z whose half angle has `one_minus_cos`: density 1 / (2 pi one_minus_cos).
inline Vec3f sample_cone(float one_minus_cos, float u, float v) { return direction_beside(u * one_minus_cos, v); }
inline float pdf_of_cone(float one_minus_cos) { return 1 / (2 * kPi * one_minus_cos); }
// Triangle, uniform: barycentric weights of its second and third vertex [Heitz19]; density 1 / area.
inline Vec2f sample_triangle(float u, float v) { return u < v ? Vec2f{0.5f * u, v - 0.5f * u} : Vec2f{u - 0.5f * v, 0.5f * v}; }

}  // namespace latent::render
