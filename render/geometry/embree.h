// render/geometry/embree.h: Embree 3 or 4, whichever CMake has found, by names that both have.
#pragma once

#if LATENT_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace latent::render {

#if LATENT_EMBREE == 4

// What Embree passes on from a ray to the functions of geometries.
using EmbreeContext = RTCRayQueryContext;

inline EmbreeContext new_context() {
    EmbreeContext context;
    rtcInitRayQueryContext(&context);
    return context;
}

inline void embree_intersect(RTCScene scene, EmbreeContext& context, RTCRayHit& ray) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context;
    rtcIntersect1(scene, &ray, &arguments);
}

inline void embree_occluded(RTCScene scene, EmbreeContext& context, RTCRay& ray) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    rtcOccluded1(scene, &ray, &arguments);
}

#else

using EmbreeContext = RTCIntersectContext;

inline EmbreeContext new_context() {
    EmbreeContext context;
    rtcInitIntersectContext(&context);
    return context;
}

inline void embree_intersect(RTCScene scene, EmbreeContext& context, RTCRayHit& ray) { rtcIntersect1(scene, &context, &ray); }

inline void embree_occluded(RTCScene scene, EmbreeContext& context, RTCRay& ray) { rtcOccluded1(scene, &context, &ray); }

#endif

}  // namespace latent::render
