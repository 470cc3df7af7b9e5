// render/load/obj/polygon.h: triangles of a polygon, which may be concave and somewhat out of plane.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/math/vec.h"

namespace latent::render {

// Three corners or more. Appends three numbers of corners per triangle, corners.size() - 2 of them, that face as the polygon does:
// ears are cut off until a triangle is left [Meisters75]. Of a quad, the first diagonal that is inside. False: it is too large and
// too jagged.
bool triangulate(std::span<const Vec3d> corners, std::vector<std::uint32_t>& triangles);

}  // namespace latent::render
