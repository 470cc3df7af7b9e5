// render/load/mesh/curve.h: curves as meshes: tubes, and ribbons. docs/scenes.md, "Conventions".
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/load/mesh/placement.h"

namespace latent::render {

using CubicBezier = std::array<Vec3d, 4>;

// The segments of a curve of degree 2 or 3, given by the points of Bezier curves that share their ends, or of a uniform B-spline.
// Empty: the number of points does not fit.
std::vector<CubicBezier> segments_of(const std::vector<Vec3d>& points, std::uint32_t degree, bool is_bspline);

Vec3d point_on(const CubicBezier& curve, double u);
Vec3d tangent_at(const CubicBezier& curve, double u);  // dp/du

// Widths from w0 at its beginning to w1 at its end. Along each segment u runs from 0 to 1.
struct CurveWidth {
    double w0, w1;
};
// Of 16 sides, with the normals of a round tube; v runs around it.
LoadedMesh tube_about(const std::vector<CubicBezier>& segments, const CurveWidth& width);
// Across the normals, which are given at both ends of each segment; v runs across it. Patches, four corners each.
LoadedMesh ribbon_along(const std::vector<CubicBezier>& segments, const CurveWidth& width, const std::vector<Vec3d>& normals);

}  // namespace latent::render
