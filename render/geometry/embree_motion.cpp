#include "render/geometry/embree_motion.h"

#include "render/geometry/embree_shapes.h"
#include "render/math/next_float.h"
#include "render/scene/bounds.h"

namespace latent::render {

namespace {

// How many intervals of time Embree takes boxes to change in at constant rates. One is exact for what does not turn.
unsigned intervals(const Motion& motion) { return motion.turns() ? 32 : 1; }

// Between two times a point strays from the straight line by an eighth of its bend times the square of the interval; so no point
// of the object strays further than the worst of its box's corners.
void bounds_over_time(const RTCBoundsFunctionArguments* args) {
    const MovingGeometry& moving = *static_cast<const MovingGeometry*>(args->geometryUserPtr);
    const Motion& motion = moving.instance->motion;
    RTCBounds object;
    rtcGetSceneBounds(moving.object, &object);
    const double count = intervals(motion);
    const Affined map = motion.at(args->timeStep / count);
    Box box;
    double bend = 0;
    for (const float x : {object.lower_x, object.upper_x}) {
        for (const float y : {object.lower_y, object.upper_y}) {
            for (const float z : {object.lower_z, object.upper_z}) {
                const Vec3d corner(Vec3f(x, y, z));
                box.add(map.point(corner));
                bend = std::max(bend, motion.bend(corner));
            }
        }
    }
    // Embree's floats err too.
    const double room = bend / (8 * count * count) + 1e-6 * std::max(max_abs(box.low), max_abs(box.high));
    const auto down = [&](double x) { return next_down(static_cast<float>(x - room)); };
    const auto up = [&](double x) { return next_up(static_cast<float>(x + room)); };
    *args->bounds_o = {down(box.low.x), down(box.low.y), down(box.low.z), 0, up(box.high.x), up(box.high.y), up(box.high.z), 0};
}

// The ray in the space of the object. False: out of range.
bool enter(const MovingGeometry& moving, RTCRay& ray) {
    const Affined object_from_world = moving.instance->motion.at(static_cast<double>(ray.time)).inverse().value();
    const Vec3f o(object_from_world.point({ray.org_x, ray.org_y, ray.org_z})),
        d(object_from_world.vector({ray.dir_x, ray.dir_y, ray.dir_z}));
    ray.org_x = o.x, ray.org_y = o.y, ray.org_z = o.z;
    ray.dir_x = d.x, ray.dir_y = d.y, ray.dir_z = d.z;
    return is_traceable(o, d);
}

void intersect(const RTCIntersectFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;  // only single rays are ever traced
    const MovingGeometry& moving = *static_cast<const MovingGeometry*>(args->geometryUserPtr);
    RTCRayHit& rayhit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    RTCRayHit inside = rayhit;
    inside.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    if (!enter(moving, inside.ray)) return;
    args->context->instID[0] = args->geomID;
    embree_intersect(moving.object, *args->context, inside);
    args->context->instID[0] = RTC_INVALID_GEOMETRY_ID;
    if (inside.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
    rayhit.hit = inside.hit;
    rayhit.ray.tfar = inside.ray.tfar;
}

void occluded(const RTCOccludedFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;
    const MovingGeometry& moving = *static_cast<const MovingGeometry*>(args->geometryUserPtr);
    RTCRay& ray = *reinterpret_cast<RTCRay*>(args->ray);
    RTCRay inside = ray;
    if (!enter(moving, inside)) return;
    args->context->instID[0] = args->geomID;
    embree_occluded(moving.object, *args->context, inside);
    args->context->instID[0] = RTC_INVALID_GEOMETRY_ID;
    if (inside.tfar < 0) ray.tfar = -kInfinity;
}

}  // namespace

RTCGeometry new_geometry(RTCDevice device, MovingGeometry& moving) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    RTCBounds object;
    rtcGetSceneBounds(moving.object, &object);
    rtcSetGeometryUserPrimitiveCount(geometry, object.lower_x <= object.upper_x ? 1 : 0);
    rtcSetGeometryTimeStepCount(geometry, intervals(moving.instance->motion) + 1);
    rtcSetGeometryUserData(geometry, &moving);
    rtcSetGeometryBoundsFunction(geometry, bounds_over_time, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcSetGeometryOccludedFunction(geometry, occluded);
    return geometry;
}

bool is_traceable(const Vec3f& origin, const Vec3f& direction) {
    const auto size = [](const Vec3f& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
    return size(origin) + size(direction) < 1.8e18f;
}

}  // namespace latent::render
