// render/geometry/tube.h: round tubes about curves. Embree finds where a ray hits one; what follows from that is in double.
#pragma once

#include "render/geometry/exact_shapes.h"
#include "render/scene/bezier.h"
#include "render/scene/description.h"

namespace latent::render {

// The points at a distance of the radius from a point of the axis, square to its direction there: open at both ends. The radius
// changes evenly with u, the parameter of the axis.
struct Tube {
    CubicBezier axis;
    double radius_0, radius_1;
    Vec3d seam;  // unit, square to the axis at its beginning: where v = 0

    double radius(double u) const { return radius_0 + u * (radius_1 - radius_0); }
};
Tube tube_of(const MeshDescription& mesh, std::uint32_t segment);

// A place on a tube, and what its surface is like there.
struct TubePoint {
    TubePoint(const Tube& tube, double u, const Vec3d& near);  // the one nearest to `near`, whose place along the axis is about u

    double u;  // along the axis
    Vec3d d;   // direction of the axis there, unit
    Vec3d n;   // unit, from the axis to the point
    Vec3d p;
    Vec3d normal;  // outwards, of any length: tilted from n as the radius changes
    Vec3d dpdu, dpdv;
    Vec3d dndu, dndv;  // derivatives of `normal`

    double v(const Tube& tube) const;  // around the axis, from 0 to 1
};

// The crossing of a ray with the tube that is nearest to t, at about u along the axis. Nothing: there is none nearby, or it is
// outside of low < t < high. So a ray that starts on a tube, to float precision, knows on which side.
struct TubeCrossing {
    double t, u;
    bool leaves;  // from inside
};
std::optional<TubeCrossing> settle(const Tube& tube, const Vec3d& o, const Vec3d& d, double t, double u, double low, double high);

}  // namespace latent::render
