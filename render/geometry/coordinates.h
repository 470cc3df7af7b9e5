// render/geometry/coordinates.h: how texture coordinates run over a surface, as pbrt-v4 has them.
#pragma once

#include "render/geometry/placed_shape.h"

namespace latent::render {

// In the space of the vertices, for a hit as surface_at takes it; `ns` is in the hemisphere of the shading normal.
SurfaceCoordinates coordinates_at(const PlacedShape& placed, std::uint32_t primitive, Vec2f uv, const Vec3d& p, const Vec3f& ns);
// Coordinates at a hit on a world, in its space.
SurfaceCoordinates coordinates_at(const PlacedWorld& world, const SurfaceHit& hit);

}  // namespace latent::render
