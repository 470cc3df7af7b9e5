#include "render/math/equal_area.h"

#include "render/math/elementary.h"

namespace latent::render {

Vec3f sphere_from_centred(const Vec2f& p) {
    const float up = std::abs(p.x), vp = std::abs(p.y);
    const bool upper = up + vp <= 1;
    const float r = upper ? up + vp : (1 - up) + (1 - vp);                // 0 at either pole
    const float quadrants = r == 0 ? 0.5f : (vp - up) / r * 0.5f + 0.5f;  // the angle phi, from 0 to 1
    const SinCos a = sincos_turns(quadrants * 0.25f);
    const float z = upper ? 1 - r * r : r * r - 1;
    const float s = r * std::sqrt(std::max(0.0f, 2 - r * r));
    return {std::copysign(a.cos, p.x) * s, std::copysign(a.sin, p.y) * s, z};
}

Vec2f centred_from_sphere(const Vec3f& d) {
    const float x = std::abs(d.x), y = std::abs(d.y);
    const float r = std::sqrt((x * x + y * y) / (1 + std::abs(d.z)));  // sqrt(1 - |z|), without cancellation
    const float phi = x == 0 && y == 0
                          ? 0
                          : static_cast<float>(std::atan2(static_cast<double>(y), static_cast<double>(x)) * 2 / std::numbers::pi);
    float v = phi * r, u = r - v;
    if (d.z < 0) {
        const float swapped = 1 - u;
        u = 1 - v;
        v = swapped;
    }
    return {std::copysign(u, d.x), std::copysign(v, d.y)};
}

}  // namespace latent::render
