#include "render/load/pbrt/shapes.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/size.h"
#include "render/load/mesh/curve.h"
#include "render/load/mesh/loop_subdivision.h"
#include "render/load/mesh/ply.h"
#include "render/load/pbrt/features.h"
#include "render/scene/check.h"

namespace latent::render {

namespace {

constexpr std::uint32_t kCorners[] = {0, 1, 3, 2};  // around a patch p00 p10 p01 p11

// Indices of a Shape directive; a mesh of one face may leave them out. Empty if an error was reported.
std::vector<std::uint32_t> read_indices(const ParameterList& list, std::size_t per_face, std::size_t vertices) {
    std::vector<std::uint32_t> indices;
    for (const double i : list.array("indices", "integer", per_face)) {
        if (!(i >= 0 && i < static_cast<double>(vertices))) {
            list.error(fmt::format("indices: {} is out of range; there are {} vertices", i, vertices));
            return {};
        }
        indices.push_back(static_cast<std::uint32_t>(i));
    }
    if (indices.empty() && vertices == per_face) {
        for (std::uint32_t i = 0; i < per_face; ++i) indices.push_back(i);
    }
    if (indices.empty()) list.error("indices: missing");
    return indices;
}

LoadedMesh read_mesh(const ParameterList& list, std::size_t per_face) {
    LoadedMesh mesh;
    const std::span<const double> p = list.array("P", "point3", 3), n = list.array("N", "normal", 3),
                                  uv = list.array("uv", "point2", 2);
    for (std::size_t i = 0; i < p.size(); i += 3) mesh.positions.emplace_back(p[i], p[i + 1], p[i + 2]);
    for (std::size_t i = 0; i < n.size(); i += 3) mesh.normals.emplace_back(Vec3d(n[i], n[i + 1], n[i + 2]));
    for (std::size_t i = 0; i < uv.size(); i += 2) mesh.uvs.push_back({static_cast<float>(uv[i]), static_cast<float>(uv[i + 1])});
    mesh.indices = read_indices(list, per_face, mesh.positions.size());
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size()) list.error("N: must have as many items as P");
    if (!mesh.uvs.empty() && mesh.uvs.size() != mesh.positions.size()) list.error("uv: must have as many items as P");
    return mesh;
}

// Vertices into the space of `ctm`; normals of unit length, turned over by ReverseOrientation as pbrt does.
void transform(LoadedMesh& mesh, const Affined& ctm, bool reverse_orientation) {
    for (Vec3d& p : mesh.positions) p = ctm.point(p);
    for (Vec3f& n : mesh.normals) {
        const Vec3d world = ctm.normal(Vec3d(n));
        const double size = length(world);
        n = size > 0 ? Vec3f(world * ((reverse_orientation ? -1 : 1) / size)) : Vec3f{};
    }
}

// A patch with p00 + p11 = p10 + p01 (to 1e-6 of its size) is flat and has a constant density: two triangles are the same surface.
bool is_parallelogram(const LoadedMesh& mesh, const std::uint32_t* v) {
    const Vec3d &p00 = mesh.positions[v[0]], &p10 = mesh.positions[v[1]], &p01 = mesh.positions[v[2]], &p11 = mesh.positions[v[3]];
    return mesh.normals.empty() && max_abs((p00 + p11) - (p10 + p01)) <= 1e-6 * std::max(max_abs(p11 - p00), max_abs(p10 - p01));
}

// Patches that are parallelograms as pairs of triangles, the others as patches.
void add_patches(const LoadedMesh& mesh, const ShapeDescription& common, std::vector<LoadedShape>& shapes) {
    LoadedMesh flat, curved;
    for (std::size_t i = 0; i + 4 <= mesh.indices.size(); i += 4) {
        const std::uint32_t* v = &mesh.indices[i];
        if (is_parallelogram(mesh, v)) {
            // Both halves begin with an edge along u, which orients anisotropic materials.
            flat.indices.insert(flat.indices.end(), {v[0], v[1], v[3], v[3], v[2], v[0]});
        } else {
            curved.indices.insert(curved.indices.end(), v, v + 4);
        }
    }
    const auto add = [&](LoadedMesh& part, ShapeKind kind) {
        if (part.indices.empty()) return;
        part.positions = mesh.positions;
        part.normals = mesh.normals;
        part.uvs = mesh.uvs;
        part.colors = mesh.colors;
        shapes.push_back({common, std::move(part)});
        shapes.back().shape.kind = kind;
        shapes.back().shape.pairs = kind == ShapeKind::kTriangles;
    };
    add(flat, ShapeKind::kTriangles);
    add(curved, ShapeKind::kBilinear);
}

void read_ply(const ParameterList& list, const Affined& ctm, bool reverse_orientation, const ShapeDescription& common,
              SceneFiles& files, std::vector<LoadedShape>& shapes) {
    const std::optional<std::string> name = list.string("filename");
    if (!name) return list.error("filename: missing");
    const Result<std::string> bytes = files.read(*name);
    if (!bytes) return list.unreadable(bytes.error());
    Result<PlyMesh> ply = parse_ply(*bytes, *name);
    if (!ply) return list.error(ply.error().message);
    if (ply->lost_normals > 0)
        list.warn(fmt::format("{}: {} not finite; the faces' own are used there", *name,
                              counted(ply->lost_normals, "normal") + (ply->lost_normals == 1 ? " is" : " are")));
    LoadedMesh mesh{.positions = std::move(ply->positions),
                    .normals = std::move(ply->normals),
                    .uvs = std::move(ply->uvs),
                    .colors = std::move(ply->colors)};
    transform(mesh, ctm, reverse_orientation);
    if (!ply->quads.empty()) {
        LoadedMesh patches = mesh;
        for (std::size_t i = 0; i < ply->quads.size(); i += 4) {
            for (const std::uint32_t corner : kCorners) patches.indices.push_back(ply->quads[i + corner]);
        }
        add_patches(patches, common, shapes);
    }
    if (!ply->triangles.empty()) {
        mesh.indices = std::move(ply->triangles);
        shapes.push_back({common, std::move(mesh)});
    }
    if (shapes.empty()) list.warn(*name + ": has no faces");
}

// A tube, or patches; "flat", which pbrt turns towards each ray, is a tube too. A tube is a mesh if it emits, or is not round.
void read_curve(const ParameterList& list, const Affined& ctm, bool reverse_orientation, bool emits, ShapeDescription common,
                std::vector<LoadedShape>& shapes) {
    const std::string type = list.string("type").value_or("flat"), basis = list.string("basis").value_or("bezier");
    const auto degree = static_cast<std::uint32_t>(list.integer("degree", 3, 2, 3));
    if (type != "flat" && type != "cylinder" && type != "ribbon")
        return list.error(fmt::format("type: \"{}\" is not one of flat, cylinder, ribbon", type));
    if (basis != "bezier" && basis != "bspline")
        return list.error(fmt::format("basis: \"{}\" is not one of bezier, bspline", basis));
    std::vector<Vec3d> points, normals;
    const std::span<const double> p = list.array("P", "point3", 3), n = list.array("N", "normal", 3);
    for (std::size_t i = 0; i < p.size(); i += 3) points.emplace_back(p[i], p[i + 1], p[i + 2]);
    for (std::size_t i = 0; i < n.size(); i += 3) normals.emplace_back(n[i], n[i + 1], n[i + 2]);
    const double both = list.number("width", 1, 0, 1e30);
    const CurveWidth width{list.number("width0", both, 0, 1e30), list.number("width1", both, 0, 1e30)};
    std::vector<CubicBezier> segments = segments_of(points, degree, basis == "bspline");
    if (segments.empty()) return list.error(fmt::format("P: {} points make no curve of degree {}", points.size(), degree));
    const bool is_ribbon = type == "ribbon";
    if (is_ribbon && normals.size() != segments.size() + 1)
        return list.error(fmt::format("N: must have {} normals, at the ends of the segments", segments.size() + 1));
    if (!is_ribbon && !emits && is_even(ctm, 1e-5)) {
        for (CubicBezier& segment : segments) {
            for (Vec3d& point : segment) point = ctm.point(point);
        }
        const double scale = length(ctm.x);
        common.kind = ShapeKind::kTube;
        common.flip_normal = reverse_orientation;
        shapes.push_back({common, tube_along(segments, {width.w0 * scale, width.w1 * scale})});
        return;
    }
    LoadedMesh mesh = is_ribbon ? ribbon_along(segments, width, normals) : tube_mesh(segments, width);
    transform(mesh, ctm, reverse_orientation);
    if (is_ribbon) {
        add_patches(mesh, common, shapes);
        for (LoadedShape& part : shapes) part.shape.ribbon = true;
        return;
    }
    shapes.push_back({common, std::move(mesh)});
}

// A part of a sphere or cylinder lies between z_min and z_max, whichever is given first.
void read_quadric(const std::string& type, const ParameterList& list, ShapeDescription& shape) {
    shape.kind = type == "sphere" ? ShapeKind::kSphere : type == "disk" ? ShapeKind::kDisk : ShapeKind::kCylinder;
    shape.radius = list.number("radius", 1, 1e-30, 1e30);
    shape.phi_max_degrees = list.number("phimax", 360, 0, 360);
    if (shape.kind == ShapeKind::kDisk) {
        shape.height = list.number("height", 0);
        shape.inner_radius = list.number("innerradius", 0, 0, shape.radius);
        return;
    }
    const double reach = shape.kind == ShapeKind::kSphere ? shape.radius : 1, a = list.number("zmin", -reach),
                 b = list.number("zmax", reach);
    shape.z_min = std::min(a, b);
    shape.z_max = std::max(a, b);
    if (shape.kind == ShapeKind::kSphere) {
        shape.z_min = std::clamp(shape.z_min, -shape.radius, shape.radius);
        shape.z_max = std::clamp(shape.z_max, -shape.radius, shape.radius);
    }
}

// Whether every vertex, or the corners of the box around a quadric, is finite as floats.
bool is_finite(const LoadedShape& loaded) {
    const auto finite = [](const Vec3d& p) { return max_abs(Vec3f(p)) < kInfinity; };
    if (loaded.mesh)
        return std::ranges::all_of(loaded.mesh->positions, finite) && std::ranges::all_of(loaded.mesh->radii, [&](double r) {
                   return finite({r, 0, 0});
               });
    const ShapeDescription& shape = loaded.shape;
    const Affined& map = shape.to_world;
    const double reach = (max_abs(map.x) + max_abs(map.y) + max_abs(map.z)) *
                         std::max({shape.radius, std::abs(shape.height), std::abs(shape.z_min), std::abs(shape.z_max)});
    return finite({max_abs(map.t) + reach, 0, 0});
}

}  // namespace

std::vector<LoadedShape> read_shape(const std::string& type, const ParameterList& list, const Affined& ctm,
                                    bool reverse_orientation, bool emits, SceneTextures& textures, SceneFiles& files) {
    std::vector<LoadedShape> shapes;
    ShapeDescription common{.location = list.directive().where};
    common.flip_normal = reverse_orientation != ctm.swaps_handedness();
    common.alpha = textures.number(list, "alpha", 1);
    if (type == "trianglemesh") {
        LoadedMesh mesh = read_mesh(list, 3);
        transform(mesh, ctm, reverse_orientation);
        shapes.push_back({common, std::move(mesh)});
    } else if (type == "bilinearmesh") {
        LoadedMesh mesh = read_mesh(list, 4);
        transform(mesh, ctm, reverse_orientation);
        add_patches(mesh, common, shapes);
    } else if (type == "loopsubdiv") {
        const auto levels = static_cast<std::uint32_t>(list.integer("levels", 3, 0, 14));
        if (Result<LoadedMesh> mesh = subdivide(read_mesh(list, 3), levels)) {
            transform(*mesh, ctm, reverse_orientation);
            shapes.push_back({common, std::move(*mesh)});
        } else {
            list.error("loopsubdiv: " + mesh.error().message);
        }
    } else if (type == "curve") {
        read_curve(list, ctm, reverse_orientation, emits, common, shapes);
    } else if (type == "plymesh") {
        read_ply(list, ctm, reverse_orientation, common, files, shapes);
    } else if (type == "sphere" || type == "disk" || type == "cylinder") {
        read_quadric(type, list, common);
        common.to_world = ctm;
        common.flip_normal = reverse_orientation;
        shapes.push_back({common});
    } else {
        list.error(unsupported("Shape", type));
        return {};
    }
    if (!std::ranges::all_of(shapes, is_finite)) list.error("Shape: exceeds the range of single precision");
    list.report_unused();
    return shapes;
}

}  // namespace latent::render
