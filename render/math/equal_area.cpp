#include "render/math/equal_area.h"

#include "render/math/elementary.h"

namespace latent::render {

Vec3f sphere_from_square(const Vec2f& p) {
    const float u = 2 * p.x - 1, v = 2 * p.y - 1;
    const float up = std::abs(u), vp = std::abs(v);
    const float signed_distance = 1 - (up + vp), d = std::abs(signed_distance), r = 1 - d;
    const float quadrants = r == 0 ? 0.5f : (vp - up) / r * 0.5f + 0.5f;  // of the angle phi, 0..1
    const SinCos a = sincos_of_turns(quadrants * 0.25f);
    const float z = std::copysign(1 - r * r, signed_distance);
    const float s = r * std::sqrt(std::max(0.0f, 2 - r * r));
    return {std::copysign(a.cos, u) * s, std::copysign(a.sin, v) * s, z};
}

Vec2f square_from_sphere(const Vec3f& d) {
    const float x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    const float r = std::sqrt(std::max(0.0f, 1 - z));
    const float phi = x == 0 && y == 0
                          ? 0
                          : static_cast<float>(std::atan2(static_cast<double>(y), static_cast<double>(x)) * 2 / std::numbers::pi);
    float v = phi * r, u = r - v;
    if (d.z < 0) {
        const float swapped = 1 - u;
        u = 1 - v;
        v = swapped;
    }
    return {(std::copysign(u, d.x) + 1) * 0.5f, (std::copysign(v, d.y) + 1) * 0.5f};
}

}  // namespace latent::render
