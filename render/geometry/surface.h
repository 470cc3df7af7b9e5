// render/geometry/surface.h: what the surface is like where a ray hit it.
#pragma once

#include "render/geometry/placed_shape.h"

namespace latent::render {

// The surface at a hit on `placed`, in the space of its vertices: `uv` are Embree's of a triangle or a tube, or the patch's; `p` is
// near the point of a tube or quadric.
SurfaceHit surface_at(const PlacedShape& placed, std::uint32_t primitive, Vec2f uv, const Vec3d& p);
// The same seen from the world.
SurfaceHit to_world(const SurfaceHit& hit, const PlacedInstance& instance);
// The surface of a world; `local` is near its point, in the space of the object that it belongs to.
SurfaceHit surface_at(const PlacedWorld& world, const PrimitivePoint& on, const Vec3d& local);

}  // namespace latent::render
