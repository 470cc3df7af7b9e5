// render/load/mesh/curve.h: curves as tubes, as meshes of tubes, and as ribbons. docs/pbrt_differences.md.
#pragma once

#include <cstdint>
#include <vector>

#include "render/load/mesh/placement.h"
#include "render/scene/bezier.h"

namespace latent::render {

// The segments of a curve of degree 2 or 3, given by the points of Bezier curves that share their ends, or of a uniform B-spline.
// Empty: the number of points does not fit.
std::vector<CubicBezier> segments_of(const std::vector<Vec3d>& points, std::uint32_t degree, bool is_bspline);

// Widths from w0 at its beginning to w1 at its end. Along each segment u runs from 0 to 1.
struct CurveWidth {
    double w0, w1;
};
// ShapeKind::kTube. v runs around it from where it is 0, a line that turns with the curve and not about it.
LoadedMesh tube_along(const std::vector<CubicBezier>& segments, const CurveWidth& width);
// The same as a mesh of 16 sides, with the normals of a round tube.
LoadedMesh tube_mesh(const std::vector<CubicBezier>& segments, const CurveWidth& width);
// Across the normals, which are given at both ends of each segment; v runs across it. Patches, four corners each.
LoadedMesh ribbon_along(const std::vector<CubicBezier>& segments, const CurveWidth& width, const std::vector<Vec3d>& normals);

}  // namespace latent::render
