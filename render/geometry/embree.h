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

// For scenes in which rays have a filter of their own.
constexpr RTCSceneFlags kRayFilter = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;

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

// `filter`, unless null, sees the hits on meshes and tubes that their own filters let through.
inline void embree_occluded(RTCScene scene, EmbreeContext& context, RTCRay& ray, RTCFilterFunctionN filter) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    arguments.filter = filter;
    if (filter != nullptr) arguments.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
    rtcOccluded1(scene, &ray, &arguments);
}

#else

using EmbreeContext = RTCIntersectContext;

constexpr RTCSceneFlags kRayFilter = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

inline EmbreeContext new_context() {
    EmbreeContext context;
    rtcInitIntersectContext(&context);
    return context;
}

inline void embree_intersect(RTCScene scene, EmbreeContext& context, RTCRayHit& ray) { rtcIntersect1(scene, &context, &ray); }

inline void embree_occluded(RTCScene scene, EmbreeContext& context, RTCRay& ray, RTCFilterFunctionN filter) {
    context.filter = filter;
    rtcOccluded1(scene, &context, &ray);
}

#endif

}  // namespace latent::render
