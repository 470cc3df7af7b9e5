// render/scene/quadric.h: spheres, disks and cylinders, whole or in part, in their own space.
#pragma once

#include "render/scene/description.h"

namespace latent::render {

inline bool is_whole_sphere(const ShapeDescription& shape) {
    return shape.kind == ShapeKind::kSphere && shape.z_min <= -shape.radius && shape.z_max >= shape.radius &&
           shape.phi_max_degrees >= 360;
}

inline double phi_max(const ShapeDescription& shape) { return shape.phi_max_degrees * std::numbers::pi / 180; }

// A sphere's zone is as large as the cylinder about it.
inline double quadric_area(const ShapeDescription& shape) {
    const double r = shape.radius, inner = shape.inner_radius;
    if (shape.kind == ShapeKind::kDisk) return 0.5 * phi_max(shape) * (r * r - inner * inner);
    return phi_max(shape) * r * (shape.z_max - shape.z_min);
}

// Area is in proportion to both u and v, from 0 to 1. `n` has unit length and points outwards, or along z.
struct QuadricPoint {
    Vec3d p, n;
};
inline QuadricPoint quadric_point(const ShapeDescription& shape, double u, double v) {
    const double phi = u * phi_max(shape), c = std::cos(phi), s = std::sin(phi), r = shape.radius, inner = shape.inner_radius;
    if (shape.kind == ShapeKind::kDisk) {
        const double ring = std::sqrt(inner * inner + v * (r * r - inner * inner));
        return {{ring * c, ring * s, shape.height}, {0, 0, 1}};
    }
    const double z = shape.z_min + v * (shape.z_max - shape.z_min);
    if (shape.kind == ShapeKind::kCylinder) return {{r * c, r * s, z}, {c, s, 0}};
    const double ring = std::sqrt(std::max(0.0, (r - z) * (r + z)));
    return {{ring * c, ring * s, z}, Vec3d(ring * c, ring * s, z) / r};
}

}  // namespace latent::render
