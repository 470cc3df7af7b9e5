#include "render/geometry/coordinates.h"

#include "render/geometry/tube.h"

namespace latent::render {

namespace {

// Any two directions along the surface.
void span_plane(const Vec3d& n, SurfaceCoordinates& c) {
    const Frame frame = Frame::from_z(Vec3f(normalize(n)));
    c.dpdu = frame.x;
    c.dpdv = frame.y;
}

// The derivative of n / |n| from that of n.
Vec3f derivative_of_unit(const Vec3d& n, const Vec3d& dn) {
    const double size = length(n);
    const Vec3d unit = n / size;
    return Vec3f((dn - unit * dot(unit, dn)) / size);
}

// The numbers are those of the corners, and of their weights' derivatives.
template <std::size_t N>
AmongVertices among(const MeshDescription& mesh, const std::uint32_t* corners, const std::array<double, N>& weight,
                    const std::array<double, N>& du, const std::array<double, N>& dv) {
    AmongVertices out;
    if (mesh.colors.empty() && mesh.more_uvs.empty()) return out;
    out.mesh = &mesh;
    for (std::size_t i = 0; i < N; ++i) {
        const auto finite = [](double x) { return std::abs(x) < 1e30 ? static_cast<float>(x) : 0.0f; };
        out.vertex[i] = corners[i];
        out.weight[i] = static_cast<float>(weight[i]);
        out.du[i] = finite(du[i]);
        out.dv[i] = finite(dv[i]);
    }
    return out;
}

SurfaceCoordinates triangle(const PlacedShape& placed, std::uint32_t primitive, Vec2f at, const Vec3f& ns) {
    const ShapeDescription& shape = placed.shape;
    const MeshDescription& mesh = *shape.mesh;
    const std::uint32_t* v = &mesh.indices[3 * std::size_t{primitive}];
    const Vec3d p0(mesh.positions[v[0]]), e1 = Vec3d(mesh.positions[v[1]]) - p0, e2 = Vec3d(mesh.positions[v[2]]) - p0;
    Vec2f t[3] = {{0, 0}, {1, 0}, {1, 1}};
    if (!mesh.uvs.empty()) {
        for (int i = 0; i < 3; ++i) t[i] = mesh.uvs[v[i]];
    } else if (shape.pairs && primitive % 2 == 1) {
        t[0] = {1, 1}, t[1] = {0, 1}, t[2] = {0, 0};
    }
    SurfaceCoordinates c{};
    const float w = 1 - at.x - at.y;
    c.uv = {t[0].x * w + t[1].x * at.x + t[2].x * at.y, t[0].y * w + t[1].y * at.x + t[2].y * at.y};
    const double a = double{t[1].x} - t[0].x, b = double{t[1].y} - t[0].y, d = double{t[2].x} - t[0].x, e = double{t[2].y} - t[0].y;
    const double determinant = a * e - b * d;
    const auto per_u = [&](const Vec3d& x1, const Vec3d& x2) { return (x1 * e - x2 * b) / determinant; };
    const auto per_v = [&](const Vec3d& x1, const Vec3d& x2) { return (x2 * a - x1 * d) / determinant; };
    c.vertices = among<3>(mesh, v, {1.0 - at.x - at.y, at.x, at.y}, {(b - e) / determinant, e / determinant, -b / determinant},
                          {(d - a) / determinant, -d / determinant, a / determinant});
    c.dpdu = Vec3f(per_u(e1, e2));
    c.dpdv = Vec3f(per_v(e1, e2));
    const float area = length_squared(cross(c.dpdu, c.dpdv));
    if (!(area > 0 && area < kInfinity)) {
        span_plane(cross(e1, e2), c);
        return c;
    }
    if (mesh.normals.empty()) return c;
    const Vec3d n0(mesh.normals[v[0]]), n1(mesh.normals[v[1]]), n2(mesh.normals[v[2]]);
    const Vec3d n = n0 * w + n1 * at.x + n2 * at.y;
    if (!(length_squared(n) > 0)) return c;
    const double side = dot(n, Vec3d(ns)) < 0 ? -1 : 1;
    c.dndu = derivative_of_unit(n, per_u(n1 - n0, n2 - n0)) * static_cast<float>(side);
    c.dndv = derivative_of_unit(n, per_v(n1 - n0, n2 - n0)) * static_cast<float>(side);
    return c;
}

SurfaceCoordinates patch(const PlacedShape& placed, std::uint32_t primitive, Vec2f at, const Vec3f& ns) {
    const MeshDescription& mesh = *placed.shape.mesh;
    const std::uint32_t* v = &mesh.indices[4 * std::size_t{primitive}];
    const PatchCorners corners = patch_corners(mesh, primitive);
    const Vec3d dpds = patch_dpdu(corners, at.y), dpdt = patch_dpdv(corners, at.x);
    // Derivatives of the patch's own (s, t) by (u, v): the inverse of what the corners' uv say.
    double dsdu = 1, dsdv = 0, dtdu = 0, dtdv = 1;
    SurfaceCoordinates c{};
    c.uv = at;
    if (!mesh.uvs.empty()) {
        PatchCorners uv;
        for (int i = 0; i < 4; ++i) uv[static_cast<std::size_t>(i)] = {mesh.uvs[v[i]].x, mesh.uvs[v[i]].y, 0};
        const Vec3d x = patch_point(uv, at.x, at.y), ds = patch_dpdu(uv, at.y), dt = patch_dpdv(uv, at.x);
        c.uv = {static_cast<float>(x.x), static_cast<float>(x.y)};
        const double determinant = ds.x * dt.y - ds.y * dt.x;
        dsdu = dt.y / determinant, dsdv = -dt.x / determinant, dtdu = -ds.y / determinant, dtdv = ds.x / determinant;
    }
    const double s = at.x, t = at.y;
    const auto along = [&](double ds, double dt) {
        return std::array{-ds * (1 - t) - dt * (1 - s), ds * (1 - t) - dt * s, dt * (1 - s) - ds * t, ds * t + dt * s};
    };
    c.vertices = among<4>(mesh, v, {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t}, along(dsdu, dtdu), along(dsdv, dtdv));
    c.dpdu = Vec3f(dpds * dsdu + dpdt * dtdu);
    c.dpdv = Vec3f(dpds * dsdv + dpdt * dtdv);
    const float area = length_squared(cross(c.dpdu, c.dpdv));
    if (!(area > 0 && area < kInfinity)) {
        const Vec3d n = cross(dpds, dpdt);
        span_plane(length_squared(n) > 0 ? n : Vec3d(ns), c);
        return c;
    }
    Vec3d n = cross(dpds, dpdt), dnds, dndt;
    if (mesh.normals.empty()) {
        const Vec3d twist = corners[0] - corners[1] - corners[2] + corners[3];
        dnds = cross(dpds, twist);
        dndt = cross(twist, dpdt);
    } else {
        PatchCorners normals;
        for (int i = 0; i < 4; ++i) normals[static_cast<std::size_t>(i)] = Vec3d(mesh.normals[v[i]]);
        n = patch_point(normals, at.x, at.y);
        dnds = patch_dpdu(normals, at.y);
        dndt = patch_dpdv(normals, at.x);
    }
    if (!(length_squared(n) > 0)) return c;
    const double side = dot(n, Vec3d(ns)) < 0 ? -1 : 1;
    const Vec3d ns_ds(derivative_of_unit(n, dnds)), ns_dt(derivative_of_unit(n, dndt));
    c.dndu = Vec3f((ns_ds * dsdu + ns_dt * dtdu) * side);
    c.dndv = Vec3f((ns_ds * dsdv + ns_dt * dtdv) * side);
    return c;
}

SurfaceCoordinates tube(const PlacedShape& placed, std::uint32_t segment, float u, const Vec3d& p, const Vec3f& ns) {
    const Tube tube = tube_of(*placed.shape.mesh, segment);
    const TubePoint at(tube, static_cast<double>(u), p);
    SurfaceCoordinates c{};
    c.uv = {static_cast<float>(at.u), static_cast<float>(at.v(tube))};
    c.dpdu = Vec3f(at.dpdu);
    c.dpdv = Vec3f(at.dpdv);
    const float area = length_squared(cross(c.dpdu, c.dpdv));
    if (!(area > 0 && area < kInfinity)) {
        span_plane(at.normal, c);
        return c;
    }
    const float side = dot(at.normal, Vec3d(ns)) < 0 ? -1 : 1;
    c.dndu = derivative_of_unit(at.normal, at.dndu) * side;
    c.dndv = derivative_of_unit(at.normal, at.dndv) * side;
    return c;
}

SurfaceCoordinates quadric(const PlacedShape& placed, const Vec3d& p, const Vec3f& ns) {
    const ShapeDescription& shape = placed.shape;
    const Vec3d local = placed.from_world.point(p);
    const double phi_max = std::max(placed.part.phi_max, 1e-9);
    const float u = static_cast<float>(QuadricPart::angle_about_z(local) / phi_max);
    const double ring = std::hypot(local.x, local.y);
    const double cos_phi = ring > 0 ? local.x / ring : 1, sin_phi = ring > 0 ? local.y / ring : 0;
    SurfaceCoordinates c{};
    Vec3d dpdu, dpdv, n, dndu, dndv;  // a normal in the quadric's own space, and how it turns
    if (shape.kind == ShapeKind::kSphere) {
        const double theta = std::atan2(ring, local.z);
        const double first = std::acos(std::clamp(shape.z_min / shape.radius, -1.0, 1.0)),
                     last = std::acos(std::clamp(shape.z_max / shape.radius, -1.0, 1.0)), turn = std::max(first - last, 1e-6);
        c.uv = {u, static_cast<float>((first - theta) / turn)};
        const double r = shape.radius * std::max(std::sin(theta), 1e-6);  // at the poles: the direction along u, however short
        dpdu = Vec3d(-sin_phi, cos_phi, 0) * (phi_max * r);
        dpdv = Vec3d(-std::cos(theta) * cos_phi, -std::cos(theta) * sin_phi, std::sin(theta)) * (turn * shape.radius);
        n = normalize(local);
        dndu = dpdu / shape.radius;
        dndv = dpdv / shape.radius;
    } else if (shape.kind == ShapeKind::kCylinder) {
        const double size = std::max(shape.z_max - shape.z_min, 1e-6 * shape.radius);
        c.uv = {u, static_cast<float>((local.z - shape.z_min) / size)};
        dpdu = Vec3d(-sin_phi, cos_phi, 0) * (phi_max * shape.radius);
        dpdv = {0, 0, size};
        n = {cos_phi, sin_phi, 0};
        dndu = dpdu / shape.radius;
    } else {
        const double width = shape.radius - shape.inner_radius;
        c.uv = {u, static_cast<float>(width > 0 ? (shape.radius - ring) / width : 0)};
        dpdu = Vec3d(-sin_phi, cos_phi, 0) * (phi_max * std::max(ring, 1e-6 * shape.radius));
        dpdv = Vec3d(-cos_phi, -sin_phi, 0) * std::max(width, 1e-6 * shape.radius);
    }
    const Affined& map = shape.to_world;
    if (shape.kind != ShapeKind::kDisk) {
        // The map turns the change of a normal as it turns normals.
        const Vec3d image = map.normal(n);
        const float side = dot(image, Vec3d(ns)) < 0 ? -1 : 1;
        c.dndu = derivative_of_unit(image, map.normal(dndu)) * side;
        c.dndv = derivative_of_unit(image, map.normal(dndv)) * side;
    }
    c.dpdu = Vec3f(map.vector(dpdu));
    c.dpdv = Vec3f(map.vector(dpdv));
    return c;
}

// All but the tangents.
SurfaceCoordinates derivatives_at(const PlacedShape& placed, std::uint32_t primitive, Vec2f uv, const Vec3d& p, const Vec3f& ns) {
    switch (placed.shape.kind) {
        case ShapeKind::kTriangles:
            return triangle(placed, primitive, uv, ns);
        case ShapeKind::kBilinear:
            return patch(placed, primitive, uv, ns);
        case ShapeKind::kTube:
            return tube(placed, primitive, uv.x, p, ns);
        case ShapeKind::kSphere:
        case ShapeKind::kDisk:
        case ShapeKind::kCylinder:
            break;
    }
    return quadric(placed, p, ns);
}

}  // namespace

SurfaceCoordinates coordinates_at(const PlacedShape& placed, std::uint32_t primitive, Vec2f uv, const Vec3d& p, const Vec3f& ns) {
    SurfaceCoordinates c = derivatives_at(placed, primitive, uv, p, ns);
    c.tangent = c.dpdu;
    c.bitangent = c.dpdv;
    if (const MeshDescription* mesh = placed.shape.mesh.get(); mesh != nullptr && !mesh->tangents.empty()) {
        const std::uint32_t* v = &mesh->indices[3 * std::size_t{primitive}];
        const double w[3] = {1.0 - uv.x - uv.y, uv.x, uv.y};
        c.tangent = Vec3f(weighted(mesh->tangents, v, w));
        c.bitangent = Vec3f(weighted(mesh->bitangents, v, w));
    }
    return c;
}

SurfaceCoordinates coordinates_at(const PlacedWorld& world, const SurfaceHit& hit) {
    const PlacedShape& placed = world.shape(hit.on);
    if (hit.on.instance == kNone) return coordinates_at(placed, hit.on.primitive, hit.on.uv, Vec3d(hit.p), hit.ns);
    std::optional<PlacedInstance> room;
    const PlacedInstance& instance = world.instance(hit.on, room);
    const Affined& map = instance.world_from_object;
    const Vec3f ns(instance.object_from_world.normal(Vec3d(hit.ns)));
    SurfaceCoordinates c = coordinates_at(placed, hit.on.primitive, hit.on.uv, instance.object_from_world.point(Vec3d(hit.p)), ns);
    for (Vec3f* v : {&c.dpdu, &c.dpdv, &c.tangent, &c.bitangent}) *v = Vec3f(map.vector(Vec3d(*v)));
    // n = m / |m|, m the image of the object's normal.
    const Vec3d m = map.normal(normalize(Vec3d(ns)));
    const double size = length(m);
    const Vec3d n = m / size;
    for (Vec3f* d : {&c.dndu, &c.dndv}) {
        const Vec3d dm = map.normal(Vec3d(*d)) / size;
        *d = Vec3f(dm - n * dot(n, dm));
    }
    return c;
}

}  // namespace latent::render
