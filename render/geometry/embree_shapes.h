// render/geometry/embree_shapes.h: a shape as Embree's geometry. Meshes are its triangles, tubes its round curves, whose hits are
// settled in double; everything else is user geometry, solved in double.
#pragma once

#include "render/geometry/embree.h"
#include "render/geometry/placed_shape.h"

namespace latent::render {

// A surface between media on a ray's way.
struct MetSurface {
    PrimitivePoint on;
    float t;
    float passed;  // share of the light; 0: it is solid
};
// Where a ray passes a tube through a hole. In the space of the tube: the distance from the ray's origin, and the radius.
struct PassedTube {
    std::uint32_t instance, shape, segment;
    bool leaves;
    double distance, radius;
};

// A ray on its way through Embree.
struct TraceContext {
    EmbreeContext embree;  // the first member, which Embree passes on
    const PlacedWorld* world;
    Stop stop;
    bool seen;                               // Ray's
    float t_max;                             // end of the ray: Embree's own shrinks to the hits that it finds
    float behind = 0;                        // in t: surfaces this far behind the hit may lie on it, and are looked for
    double hit_t = kInfinity;                // for kFirstSolid: the first hit so far on a watched shape
    float passed = 1;                        // Line's
    std::vector<MetSurface> met{};           // surfaces between media, in no order, also a little behind the hit
    std::vector<PassedTube> passed_tubes{};  // Embree may find a crossing of a tube more than once; it counts once
};
inline TraceContext& trace_context(EmbreeContext* context) { return *reinterpret_cast<TraceContext*>(context); }

// `placed` stays where it is.
RTCGeometry new_geometry(RTCDevice device, PlacedShape& placed);

}  // namespace latent::render
