#include "render/geometry/surface.h"

#include <algorithm>
#include <array>

#include "render/geometry/tube.h"

namespace latent::render {

namespace {

constexpr float kHalfUlp = 0x1p-24f;     // relative error of a double rounded to float
constexpr float kPlaneError = 0x1p-21f;  // error of Embree's distance to a triangle's plane, per its extent

// The error of a surface point that was computed in double from numbers up to `size`. Near the origin, p itself is much smaller.
float exact_error(const Vec3f& p, double size) {
    constexpr double kDoubleError = 0x1p-48;
    return 2 * kHalfUlp * max_abs(p) + static_cast<float>(kDoubleError * size);
}

double max_abs(const std::array<Vec3d, 4>& points) {
    double size = 0;
    for (const Vec3d& p : points) size = std::max(size, render::max_abs(p));
    return size;
}

SurfaceHit common_hit(const ShapeDescription& shape) {
    SurfaceHit hit{};
    hit.material = shape.material;
    hit.ribbon = shape.ribbon;
    hit.backdrop = shape.backdrop;
    hit.emitter = kNone;
    hit.error_per_length = kRayError;
    hit.inside_medium = shape.inside_medium;
    hit.outside_medium = shape.outside_medium;
    return hit;
}

// Interpolates vertex normals with weights w; orients ng to them, as pbrt does for meshes that have normals.
void shade(const MeshDescription& mesh, const std::uint32_t* v, std::span<const double> w, SurfaceHit& hit) {
    const Vec3d ns = weighted(mesh.normals, v, w);
    const double size = length(ns);
    if (!(size > 0)) return;
    hit.ns = Vec3f(ns / size);
    hit.ng = face_forward(hit.ng, hit.ns);
}

SurfaceHit triangle(const PlacedShape& placed, std::uint32_t primitive, Vec2f uv) {
    const ShapeDescription& shape = placed.shape;
    const MeshDescription& mesh = *shape.mesh;
    const std::uint32_t* v = &mesh.indices[3 * std::size_t{primitive}];
    const Vec3f &p0 = mesh.positions[v[0]], &p1 = mesh.positions[v[1]], &p2 = mesh.positions[v[2]];
    const double w[3] = {1.0 - uv.x - uv.y, uv.x, uv.y};

    SurfaceHit hit = common_hit(shape);
    hit.p = Vec3f(Vec3d(p0) * w[0] + Vec3d(p1) * w[1] + Vec3d(p2) * w[2]);
    const Vec3f e1 = p1 - p0, e2 = p2 - p0;
    hit.error = kHalfUlp * max_abs(hit.p) + kPlaneError * std::max(max_abs(e1), max_abs(e2));
    hit.ng = normalize(cross(e1, e2)) * (shape.flip_normal ? -1.0f : 1.0f);
    hit.ns = hit.ng;
    hit.dpdu = e1;
    if (!mesh.uvs.empty()) {
        const Vec2f &t0 = mesh.uvs[v[0]], &t1 = mesh.uvs[v[1]], &t2 = mesh.uvs[v[2]];
        const float determinant = (t1.x - t0.x) * (t2.y - t0.y) - (t1.y - t0.y) * (t2.x - t0.x);
        const Vec3f dpdu = (e1 * (t2.y - t0.y) - e2 * (t1.y - t0.y)) / determinant;
        if (determinant != 0 && max_abs(dpdu) < kInfinity) hit.dpdu = dpdu;
    }
    if (!mesh.tangents.empty()) {
        const Vec3f along(weighted(mesh.tangents, v, w)), off = cross(hit.ng, along);
        if (length_squared(off) > 1e-6f * length_squared(along)) hit.dpdu = along;
    }
    if (!mesh.normals.empty()) shade(mesh, v, w, hit);
    return hit;
}

SurfaceHit patch(const PlacedShape& placed, std::uint32_t primitive, Vec2f uv) {
    const ShapeDescription& shape = placed.shape;
    const MeshDescription& mesh = *shape.mesh;
    const std::uint32_t* v = &mesh.indices[4 * std::size_t{primitive}];
    const PatchCorners corners = patch_corners(mesh, primitive);

    SurfaceHit hit = common_hit(shape);
    hit.p = Vec3f(patch_point(corners, uv.x, uv.y));
    hit.error = exact_error(hit.p, max_abs(corners));
    const Vec3d dpdu = patch_dpdu(corners, uv.y), dpdv = patch_dpdv(corners, uv.x), n = cross(dpdu, dpdv);
    hit.ng = Vec3f(n / length(n)) * (shape.flip_normal ? -1.0f : 1.0f);
    hit.ns = hit.ng;
    hit.dpdu = Vec3f(dpdu);
    const double w[4] = {(1.0 - uv.x) * (1.0 - uv.y), uv.x * (1.0 - uv.y), (1.0 - uv.x) * uv.y, 1.0 * uv.x * uv.y};
    if (!mesh.normals.empty()) shade(mesh, v, w, hit);
    return hit;
}

// `p` is near the surface, and `u` near its place along the axis.
SurfaceHit tube(const PlacedShape& placed, std::uint32_t segment, float u, const Vec3d& p) {
    const Tube tube = tube_of(*placed.shape.mesh, segment);
    const TubePoint at(tube, static_cast<double>(u), p);
    SurfaceHit hit = common_hit(placed.shape);
    hit.p = Vec3f(at.p);
    hit.error = exact_error(hit.p, max_abs(tube.axis));
    const bool inwards = placed.shape.flip_normal && !placed.hollow;
    hit.ng = Vec3f(at.normal * ((inwards ? -1 : 1) / length(at.normal)));
    hit.ns = hit.ng;
    hit.dpdu = Vec3f(at.dpdu);
    return hit;
}

// `p` is near the surface, in the space around it.
SurfaceHit quadric(const PlacedShape& placed, const Vec3d& p) {
    const ShapeDescription& shape = placed.shape;
    const Vec3d local = placed.from_world.point(p);
    Vec3d on, n;  // the point, and the normal there
    if (shape.kind == ShapeKind::kSphere) {
        n = on = local * (shape.radius / length(local));
    } else if (shape.kind == ShapeKind::kCylinder) {
        const double share = shape.radius / std::hypot(local.x, local.y);
        on = {local.x * share, local.y * share, local.z};
        n = {on.x, on.y, 0};
    } else {
        on = {local.x, local.y, shape.height};
        n = {0, 0, 1};
    }

    SurfaceHit hit = common_hit(shape);
    hit.p = Vec3f(shape.to_world.point(on));
    hit.error = exact_error(hit.p, static_cast<double>(render::max_abs(hit.p)) + render::max_abs(shape.to_world.t));
    n = shape.to_world.normal(n);
    hit.ng = Vec3f(n * ((shape.flip_normal ? -1 : 1) / length(n)));
    hit.ns = hit.ng;
    hit.dpdu = Vec3f(shape.to_world.vector(on.x != 0 || on.y != 0 ? Vec3d(-on.y, on.x, 0) : Vec3d(1, 0, 0)));
    return hit;
}

}  // namespace

// 8 half ulps of what is added up in the object's space, seen from the world.
PlacedInstance::PlacedInstance(const std::vector<PlacedShape>& of, const Affined& map)
    : shapes(&of), world_from_object(map), object_from_world(map.inverse().value()) {
    const auto norm = [](const Affined& a) { return max_abs(a.x) + max_abs(a.y) + max_abs(a.z); };
    error_factor = static_cast<float>(0x1p-21 * norm(map) * norm(object_from_world));
}

SurfaceHit surface_at(const PlacedShape& placed, std::uint32_t primitive, Vec2f uv, const Vec3d& p) {
    SurfaceHit hit = placed.shape.kind == ShapeKind::kTriangles  ? triangle(placed, primitive, uv)
                     : placed.shape.kind == ShapeKind::kBilinear ? patch(placed, primitive, uv)
                     : placed.shape.kind == ShapeKind::kTube     ? tube(placed, primitive, uv.x, p)
                                                                 : quadric(placed, p);
    hit.ns = face_forward(hit.ns, hit.ng);
    if (placed.first_emitter != kNone) hit.emitter = placed.first_emitter + primitive;
    return hit;
}

SurfaceHit to_world(const SurfaceHit& hit, const PlacedInstance& instance) {
    const Affined& map = instance.world_from_object;
    const auto unit = [](const Vec3d& v) { return Vec3f(v / length(v)); };
    SurfaceHit out = hit;
    out.p = Vec3f(map.point(Vec3d(hit.p)));
    out.error = static_cast<float>(hit.error * (max_abs(map.x) + max_abs(map.y) + max_abs(map.z))) +
                instance.error_factor * (max_abs(out.p) + static_cast<float>(max_abs(map.t)));
    out.error_per_length = std::max(kRayError, instance.error_factor);
    out.ng = unit(map.normal(Vec3d(hit.ng)));
    out.ns = face_forward(unit(map.normal(Vec3d(hit.ns))), out.ng);
    out.dpdu = Vec3f(map.vector(Vec3d(hit.dpdu)));
    return out;
}

SurfaceHit surface_at(const PlacedWorld& world, const PrimitivePoint& on, const Vec3d& local) {
    SurfaceHit hit = surface_at(world.shape(on), on.primitive, on.uv, local);
    std::optional<PlacedInstance> room;
    if (on.instance != kNone) hit = to_world(hit, world.instance(on, room));
    hit.on = on;
    return hit;
}

}  // namespace latent::render
