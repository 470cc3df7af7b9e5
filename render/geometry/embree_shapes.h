// render/geometry/embree_shapes.h: a shape as Embree's geometry. Meshes are its triangles, tubes its round curves, whose hits are
// settled in double; everything else is user geometry, solved in double.
#pragma once

#include "render/geometry/embree.h"
#include "render/geometry/placed_shape.h"

namespace latent::render {

// A surface that is there in part, and the share of the light that passes it.
struct PassedSurface {
    float t, share;
};
// A surface that a ray meets, in no order.
struct MetSurface {
    PrimitivePoint on;
    float t;
};
// Where a ray passes a tube through a hole. In the space of the tube: the distance from the ray's origin, and the radius.
struct PassedTube {
    std::uint32_t instance, shape, segment;
    bool leaves;
    double distance, radius;
};

// Embree's filter of rays that gather `met`.
void gather_met(const RTCFilterFunctionNArguments* args);

// Of every ray.
struct TraceContext {
    EmbreeContext embree;  // the first member, which Embree passes on
    const PlacedWorld* world;
    float t_max;  // of the ray: Embree's own shrinks to the hits that it finds
    // Surfaces that are there in part let every ray pass, and this gathers what they let pass: the product, or each by itself,
    // in any order. Neither: a hash decides.
    float* passed = nullptr;
    std::vector<PassedSurface>* passed_each = nullptr;
    // Of a shadow ray, which then nothing stops: all surfaces on its way, but not this primitive, nor those with open holes.
    std::vector<MetSurface>* met = nullptr;
    const PrimitivePoint* met_but = nullptr;
    std::vector<PassedTube> passed_tubes{};  // Embree may find a crossing of a tube more than once; it counts once

    RTCFilterFunctionN filter() const { return met == nullptr ? nullptr : gather_met; }
};
inline TraceContext& trace_context(EmbreeContext* context) { return *reinterpret_cast<TraceContext*>(context); }

// `placed` stays where it is.
RTCGeometry new_geometry(RTCDevice device, PlacedShape& placed);

}  // namespace latent::render
