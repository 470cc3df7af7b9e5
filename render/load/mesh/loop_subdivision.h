// render/load/mesh/loop_subdivision.h: smooth surfaces from coarse triangles, by Loop's scheme [Loop87].
#pragma once

#include <cstdint>

#include "base/result.h"
#include "render/load/mesh/placement.h"

namespace latent::render {

// Divides every triangle of `mesh` into 4, `levels` times, then moves the vertices to where infinitely many divisions would bring
// them, with the normals of the limit surface (opposite to (p1 - p0) x (p2 - p0), as pbrt has them). Only positions and indices
// are used. Errors: kUnsupported, if triangles that share an edge are more than two or wound against each other, if they meet at
// a vertex alone, or, before any memory is taken, if the result has more than 2^24
// triangles.
Result<LoadedMesh> subdivide(const LoadedMesh& mesh, std::uint32_t levels);

}  // namespace latent::render
