// render/scene/bezier.h: cubic Bezier curves.
#pragma once

#include <array>

#include "render/math/vec.h"

namespace latent::render {

using CubicBezier = std::array<Vec3d, 4>;

inline Vec3d mix(const Vec3d& a, const Vec3d& b, double t) { return a * (1 - t) + b * t; }

inline Vec3d point_on(const CubicBezier& c, double u) {
    const Vec3d a = mix(c[0], c[1], u), b = mix(c[1], c[2], u), e = mix(c[2], c[3], u);
    return mix(mix(a, b, u), mix(b, e, u), u);
}
// dp/du
inline Vec3d tangent_at(const CubicBezier& c, double u) {
    return mix(mix(c[1] - c[0], c[2] - c[1], u), mix(c[2] - c[1], c[3] - c[2], u), u) * 3;
}
// d2p/du2
inline Vec3d bend_at(const CubicBezier& c, double u) { return mix(c[0] - c[1] * 2 + c[2], c[1] - c[2] * 2 + c[3], u) * 6; }

// `side`, square to the direction `from`, as it stands when that turns into `to` the shortest way. Directions of unit length.
inline Vec3d turned(const Vec3d& side, const Vec3d& from, const Vec3d& to) {
    const double opposite = 1 + dot(from, to);
    if (!(opposite > 1e-9)) return side;
    const Vec3d image = side - (from + to) * (dot(side, to) / opposite);
    return normalize(image - to * dot(image, to));
}

}  // namespace latent::render
