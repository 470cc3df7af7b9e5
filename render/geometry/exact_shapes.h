// render/geometry/exact_shapes.h: rays against the shapes that Embree has no kernel for, in double, so that a ray that starts on
// such a shape (to float precision) knows on which side.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "render/math/vec.h"

namespace latent::render {

struct ExactHit {
    double t;
    double u = 0, v = 0;  // coordinates on a patch
};

// The first hit with low < t < high, or none. The direction need not have unit length.

// The part of a quadric with z_min <= z <= z_max, at angles up to phi_max about z.
struct QuadricPart {
    double z_min = -std::numeric_limits<double>::infinity(), z_max = std::numeric_limits<double>::infinity();
    double phi_max = 2 * std::numbers::pi;

    bool holds(const Vec3d& p) const {
        return p.z >= z_min && p.z <= z_max && (phi_max >= 2 * std::numbers::pi || angle_about_z(p) <= phi_max);
    }
    // From 0 to 2 pi.
    static double angle_about_z(const Vec3d& p) {
        const double phi = std::atan2(p.y, p.x);
        return phi < 0 ? phi + 2 * std::numbers::pi : phi;
    }
};

// |p| = radius, from outside and inside: the roots of t^2 d.d + 2 t o.d + o.o - r^2, found without cancellation [PBRT4 6.2.2].
std::optional<ExactHit> intersect_sphere(const Vec3d& o, const Vec3d& d, double radius, const QuadricPart& part, double low,
                                         double high);

// |(x, y)| = radius.
std::optional<ExactHit> intersect_cylinder(const Vec3d& o, const Vec3d& d, double radius, const QuadricPart& part, double low,
                                           double high);

// z = height, inner <= |(x, y)| <= radius.
std::optional<ExactHit> intersect_disk(const Vec3d& o, const Vec3d& d, double height, double inner, double radius,
                                       const QuadricPart& part, double low, double high);

// p(u, v) = (1 - u)(1 - v) p00 + u (1 - v) p10 + (1 - u) v p01 + u v p11: the u of the straight lines across the patch that the ray
// meets solve a quadratic [Reshetov19].
using PatchCorners = std::array<Vec3d, 4>;  // p00 p10 p01 p11
std::optional<ExactHit> intersect_patch(const Vec3d& o, const Vec3d& d, const PatchCorners& p, double low, double high);

inline Vec3d patch_point(const PatchCorners& p, double u, double v) {
    return (p[0] * (1 - u) + p[1] * u) * (1 - v) + (p[2] * (1 - u) + p[3] * u) * v;
}
inline Vec3d patch_dpdu(const PatchCorners& p, double v) { return (p[1] - p[0]) * (1 - v) + (p[3] - p[2]) * v; }
inline Vec3d patch_dpdv(const PatchCorners& p, double u) { return (p[2] - p[0]) * (1 - u) + (p[3] - p[1]) * u; }

}  // namespace latent::render
