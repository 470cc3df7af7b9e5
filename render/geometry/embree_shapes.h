// render/geometry/embree_shapes.h: a shape as Embree's geometry. Meshes are its triangles, everything else is user geometry, solved
// in double.
#pragma once

#include <embree3/rtcore.h>

#include "render/geometry/placed_shape.h"

namespace latent::render {

// Of every ray.
struct TraceContext {
    RTCIntersectContext embree;  // what Embree passes on: the first member
    const PlacedWorld* world;
    float* passed = nullptr;  // gathers the shares that surfaces which are there in part let pass; null: a hash decides
};

// `placed` stays where it is.
RTCGeometry new_geometry(RTCDevice device, PlacedShape& placed);

}  // namespace latent::render
