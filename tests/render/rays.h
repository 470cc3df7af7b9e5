// tests/render/rays.h: single rays, for tests.
#pragma once

#include "render/geometry/geometry.h"

namespace latent::render::testing {

inline std::optional<SurfaceHit> first_hit(const Geometry& geometry, const Ray& ray) {
    return geometry.trace(ray, Stop::kFirstSolid).hit;
}
// The share of the light that no surface stops.
inline float share_passed(const Geometry& geometry, const Ray& ray) { return geometry.trace(ray, Stop::kAnySolid).passed; }

}  // namespace latent::render::testing
