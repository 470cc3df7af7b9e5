#include "render/geometry/embree_shapes.h"

#include "render/geometry/holes.h"
#include "render/geometry/surface.h"
#include "render/geometry/tube.h"
#include "render/math/next_float.h"
#include "render/scene/bounds.h"

namespace latent::render {

namespace {

Vec3f direction_of(const RTCRay& ray) { return {ray.dir_x, ray.dir_y, ray.dir_z}; }
Vec3d point_on(const RTCRay& ray, double t) { return Vec3d(ray.org_x, ray.org_y, ray.org_z) + Vec3d(direction_of(ray)) * t; }

// The share of the light that passes the surface at t (`ray`: in the space of its object): of a ray to the first solid all or
// nothing, as a hash decides.
float share_passed(const TraceContext& context, const PlacedShape& placed, const PrimitivePoint& on, const RTCRay& ray, double t) {
    if (is_interface(placed.shape.material)) return 1;
    if (!placed.has_holes()) return 0;
    const SurfaceHit hit = surface_at(*context.world, on, point_on(ray, t));
    const float opacity = opacity_at(*context.world, hit);
    if (context.stop == Stop::kFirstSolid) return is_hole_at(on, hit.p, direction_of(ray), opacity) ? 1 : 0;
    return 1 - std::clamp(opacity, 0.0f, 1.0f);
}

// Whether the ray ends on a watched shape, at t. If the shape parts media, `met` gets it, too.
bool stops(TraceContext& context, const PlacedShape& placed, const PrimitivePoint& on, const RTCRay& ray, double t) {
    if (placed.shape.backdrop && !context.seen) return false;
    if (placed.hollow && placed.shape.kind != ShapeKind::kTube &&
        dot(surface_at(placed, on.primitive, on.uv, point_on(ray, t)).ng, direction_of(ray)) > 0)
        return false;
    if (context.stop == Stop::kNothing && !is_interface(placed.shape.material)) return false;
    const float passed = share_passed(context, placed, on, ray, t);
    if (placed.parts_media()) {
        context.met.push_back({on, static_cast<float>(t), passed});
    } else if (passed > 0) {
        context.passed *= passed;
    }
    if (passed > 0 || t >= context.hit_t) return false;
    if (context.stop == Stop::kFirstSolid) context.hit_t = t;
    return true;
}

// How far Embree is to look for more, after a hit at t.
float reach_after(const TraceContext& context, float t) { return std::min(t + context.behind, context.t_max); }

// The box of a primitive of user geometry, in floats that contain it.
void bounds_of(const RTCBoundsFunctionArguments* args) {
    const PlacedShape& placed = *static_cast<const PlacedShape*>(args->geometryUserPtr);
    const ShapeDescription& shape = placed.shape;
    Box box;
    if (shape.kind == ShapeKind::kBilinear) {
        for (const Vec3d& c : patch_corners(*shape.mesh, args->primID)) box.add(c);
    } else {
        box = quadric_box(shape);
    }
    const auto down = [](double x) { return next_down(static_cast<float>(x)); };
    const auto up = [](double x) { return next_up(static_cast<float>(x)); };
    *args->bounds_o = {down(box.low.x), down(box.low.y), down(box.low.z), 0, up(box.high.x), up(box.high.y), up(box.high.z), 0};
}

std::optional<ExactHit> intersect_exact(const PlacedShape& placed, std::uint32_t primitive, const RTCRay& ray) {
    const ShapeDescription& shape = placed.shape;
    const Vec3d o(ray.org_x, ray.org_y, ray.org_z), d(ray.dir_x, ray.dir_y, ray.dir_z);
    if (shape.kind == ShapeKind::kBilinear)
        return intersect_patch(o, d, patch_corners(*shape.mesh, primitive), ray.tnear, ray.tfar);
    const Vec3d local_o = placed.from_world.point(o), local_d = placed.from_world.vector(d);
    if (shape.kind == ShapeKind::kSphere) return intersect_sphere(local_o, local_d, shape.radius, placed.part, ray.tnear, ray.tfar);
    if (shape.kind == ShapeKind::kCylinder)
        return intersect_cylinder(local_o, local_d, shape.radius, placed.part, ray.tnear, ray.tfar);
    return intersect_disk(local_o, local_d, shape.height, shape.inner_radius, shape.radius, placed.part, ray.tnear, ray.tfar);
}

// The first hit that stops the ray.
std::optional<ExactHit> first_stop(const PlacedShape& placed, EmbreeContext* context, unsigned shape, std::uint32_t primitive,
                                   RTCRay ray) {
    while (true) {
        const std::optional<ExactHit> hit = intersect_exact(placed, primitive, ray);
        if (!hit) return hit;
        const Vec2f uv{static_cast<float>(hit->u), static_cast<float>(hit->v)};
        const PrimitivePoint on{context->instID[0], shape, primitive, uv, ray.time};
        if (stops(trace_context(context), placed, on, ray, hit->t)) return hit;
        ray.tnear = next_up(static_cast<float>(hit->t));
    }
}

// For every ray that comes near: inlined, or the hit would be passed on through memory.
[[gnu::always_inline]] inline std::optional<ExactHit> first_hit(const PlacedShape& placed, EmbreeContext* context, unsigned shape,
                                                                std::uint32_t primitive, const RTCRay& ray) {
    return placed.is_watched ? first_stop(placed, context, shape, primitive, ray) : intersect_exact(placed, primitive, ray);
}

void intersect_user(const RTCIntersectFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;  // only single rays are ever traced
    RTCRayHit& rayhit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    const std::optional<ExactHit> hit =
        first_hit(*static_cast<const PlacedShape*>(args->geometryUserPtr), args->context, args->geomID, args->primID, rayhit.ray);
    if (!hit) return;
    rayhit.ray.tfar = reach_after(trace_context(args->context), static_cast<float>(hit->t));
    rayhit.hit.u = static_cast<float>(hit->u);
    rayhit.hit.v = static_cast<float>(hit->v);
    rayhit.hit.primID = args->primID;
    rayhit.hit.geomID = args->geomID;
    rayhit.hit.instID[0] = args->context->instID[0];
}

void occluded_user(const RTCOccludedFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;
    RTCRay& ray = *reinterpret_cast<RTCRay*>(args->ray);
    if (first_hit(*static_cast<const PlacedShape*>(args->geometryUserPtr), args->context, args->geomID, args->primID, ray))
        ray.tfar = -kInfinity;
}

// Embree's filter of watched meshes and tubes: rejects the hits that do not stop the ray.
void filter(const RTCFilterFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;
    TraceContext& context = trace_context(args->context);
    RTCRay& ray = *reinterpret_cast<RTCRay*>(args->ray);
    const RTCHit& hit = *reinterpret_cast<const RTCHit*>(args->hit);
    const PrimitivePoint on{args->context->instID[0], hit.geomID, hit.primID, {hit.u, hit.v}, ray.time};
    if (stops(context, *static_cast<const PlacedShape*>(args->geometryUserPtr), on, ray, static_cast<double>(ray.tfar)))
        ray.tfar = reach_after(context, ray.tfar);
    else
        args->valid[0] = 0;
}

// Whether the ray has passed this crossing of a tube before: of the same segment, or of its neighbour at their common end.
bool is_passed(const TraceContext& context, const PassedTube& at) {
    return std::any_of(context.passed_tubes.begin(), context.passed_tubes.end(), [&](const PassedTube& before) {
        const std::uint32_t apart = before.segment < at.segment ? at.segment - before.segment : before.segment - at.segment;
        return before.instance == at.instance && before.shape == at.shape && apart <= 1 && before.leaves == at.leaves &&
               std::abs(before.distance - at.distance) <= 1e-3 * at.radius;
    });
}

// For tubes: Embree's hit is exact to a few float ulps, which is not enough to tell on which side of its own surface a ray starts
// or ends.
void settle_hit(const RTCFilterFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;
    const PlacedShape& placed = *static_cast<const PlacedShape*>(args->geometryUserPtr);
    const RTCRay& ray = *reinterpret_cast<const RTCRay*>(args->ray);
    RTCHit& hit = *reinterpret_cast<RTCHit*>(args->hit);
    const Vec3d o(ray.org_x, ray.org_y, ray.org_z), d(direction_of(ray));
    const Tube tube = tube_of(*placed.shape.mesh, hit.primID);
    const std::optional<TubeCrossing> settled =
        settle(tube, o, d, static_cast<double>(ray.tfar), static_cast<double>(hit.u), static_cast<double>(ray.tnear),
               static_cast<double>(trace_context(args->context).t_max));
    if (!settled || (placed.hollow && settled->leaves)) {
        args->valid[0] = 0;
        return;
    }
    hit.u = static_cast<float>(settled->u);
    if (!placed.is_watched) return;
    TraceContext& context = trace_context(args->context);
    const PassedTube crossing{context.embree.instID[0], hit.geomID, hit.primID, settled->leaves, settled->t * length(d),
                              tube.radius(settled->u)};
    if (is_passed(context, crossing)) {
        args->valid[0] = 0;
        return;
    }
    filter(args);
    if (args->valid[0] == 0) context.passed_tubes.push_back(crossing);
}

RTCGeometry new_tubes(RTCDevice device, PlacedShape& placed) {
    const MeshDescription& mesh = *placed.shape.mesh;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_BEZIER_CURVE);
    float* p = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), mesh.positions.size()));
    for (std::size_t i = 0; p != nullptr && i < mesh.positions.size(); ++i) {
        const Vec3f& v = mesh.positions[i];
        *p++ = v.x, *p++ = v.y, *p++ = v.z, *p++ = mesh.radii[i];
    }
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, mesh.indices.data(), 0, sizeof(std::uint32_t),
                               mesh.indices.size());
    rtcSetGeometryUserData(geometry, &placed);
    rtcSetGeometryIntersectFilterFunction(geometry, settle_hit);
    rtcSetGeometryOccludedFilterFunction(geometry, settle_hit);
    return geometry;
}

RTCGeometry new_mesh(RTCDevice device, PlacedShape& placed) {
    const MeshDescription& mesh = *placed.shape.mesh;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float* p = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
    if (p != nullptr) {
        for (const Vec3f& v : mesh.positions) *p++ = v.x, *p++ = v.y, *p++ = v.z;
    }
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(), 0,
                               3 * sizeof(std::uint32_t), mesh.indices.size() / 3);
    if (placed.is_watched) {
        rtcSetGeometryUserData(geometry, &placed);
        rtcSetGeometryIntersectFilterFunction(geometry, filter);
        rtcSetGeometryOccludedFilterFunction(geometry, filter);
    }
    return geometry;
}

RTCGeometry new_user_geometry(RTCDevice device, PlacedShape& placed) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    const bool patches = placed.shape.kind == ShapeKind::kBilinear;
    rtcSetGeometryUserPrimitiveCount(geometry, patches ? static_cast<unsigned>(placed.shape.mesh->indices.size() / 4) : 1);
    rtcSetGeometryUserData(geometry, &placed);
    rtcSetGeometryBoundsFunction(geometry, bounds_of, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect_user);
    rtcSetGeometryOccludedFunction(geometry, occluded_user);
    return geometry;
}

}  // namespace

RTCGeometry new_geometry(RTCDevice device, PlacedShape& placed) {
    switch (placed.shape.kind) {
        case ShapeKind::kTriangles:
            return new_mesh(device, placed);
        case ShapeKind::kTube:
            return new_tubes(device, placed);
        case ShapeKind::kBilinear:
        case ShapeKind::kSphere:
        case ShapeKind::kDisk:
        case ShapeKind::kCylinder:
            break;
    }
    return new_user_geometry(device, placed);
}

}  // namespace latent::render
