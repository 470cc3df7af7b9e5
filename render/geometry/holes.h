// render/geometry/holes.h: surfaces that are there in part.
#pragma once

#include "render/geometry/placed_shape.h"

namespace latent::render {

// The share of the light that the surface stops at a hit; 1 and more: all of it.
float opacity_at(const PlacedWorld& world, const SurfaceHit& hit);

// Whether a ray in direction d passes the surface at p through a hole: a hash decides, for each shape by itself.
bool is_hole_at(const PrimitivePoint& on, const Vec3f& p, const Vec3f& d, float opacity);

}  // namespace latent::render
