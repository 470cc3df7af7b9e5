// The pieces of area lights, found among the shapes of the world.
#include <fmt/format.h>

#include "render/geometry/embree_geometry.h"

namespace latent::render {

Status EmbreeGeometry::add_emitters(const SceneDescription& scene) {
    for (PlacedShape& placed : shapes_) {
        const ShapeDescription& shape = placed.shape;
        if (shape.area_light == kNone) continue;
        const AreaLightDescription& light = scene.area_lights[shape.area_light];
        const SourceLocation& where = shape.location;
        const auto refuse = [&](std::string_view what) {
            return Error{ErrorCode::kUnsupported, fmt::format("{}:{}:{}: an area light on {} is not supported",
                                                              scene.files[where.file], where.line, where.column, what)};
        };
        placed.first_emitter = static_cast<std::uint32_t>(emitters_.size());
        // Of the piece that `power` is given for.
        const auto scale = [&](double area) {
            const double sides = light.two_sided ? 2 : 1;
            return static_cast<float>(light.scale * (light.power ? *light.power / (std::numbers::pi * area * sides) : 1));
        };
        Emitter emitter{
            .area_light = shape.area_light, .inside_medium = shape.inside_medium, .outside_medium = shape.outside_medium};
        if (shape.kind == ShapeKind::kTriangles) {
            const MeshDescription& mesh = *shape.mesh;
            for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
                const SurfaceHit hit = surface_at(placed, static_cast<std::uint32_t>(i / 3), {1 / 3.0f, 1 / 3.0f}, {});
                emitter.p = mesh.positions[mesh.indices[i]];
                emitter.e1 = mesh.positions[mesh.indices[i + 1]] - emitter.p;
                emitter.e2 = mesh.positions[mesh.indices[i + 2]] - emitter.p;
                const double area = 0.5 * length(cross(Vec3d(emitter.e1), Vec3d(emitter.e2)));
                emitter.n = area > 0 ? hit.ng : Vec3f{};
                emitter.area = static_cast<float>(area);
                emitter.scale = area > 0 ? scale(shape.pairs ? 2 * area : area) : 0;
                emitters_.push_back(emitter);
            }
        } else if (shape.kind == ShapeKind::kSphere) {
            const Affined& m = shape.to_world;
            const double s = length(m.x), tolerance = 1e-5 * s;
            const bool round = std::abs(length(m.y) - s) < tolerance && std::abs(length(m.z) - s) < tolerance &&
                               std::abs(dot(m.x, m.y)) < tolerance * s && std::abs(dot(m.y, m.z)) < tolerance * s &&
                               std::abs(dot(m.z, m.x)) < tolerance * s;
            if (!round) return refuse("a sphere that is stretched");
            const double radius = shape.radius * s, area = 4 * std::numbers::pi * radius * radius;
            emitter.is_sphere = true;
            emitter.p = Vec3f(m.t);
            emitter.radius = static_cast<float>(radius);
            emitter.inward = shape.flip_normal;
            emitter.area = static_cast<float>(area);
            emitter.scale = scale(area);
            emitters_.push_back(emitter);
        } else {
            return refuse(shape.kind == ShapeKind::kDisk ? "a disk" : "a patch that is no parallelogram");
        }
    }
    return {};
}

}  // namespace latent::render
