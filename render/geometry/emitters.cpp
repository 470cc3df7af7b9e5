// The pieces of area lights, found among the shapes of the world.
#include "render/geometry/embree_geometry.h"
#include "render/scene/check.h"

namespace latent::render {

Status EmbreeGeometry::add_emitters(const SceneDescription& scene) {
    for (PlacedShape& placed : shapes_) {
        const ShapeDescription& shape = placed.shape;
        if (shape.area_light == kNone) continue;
        if (const Refusals r = check_area_light(shape); !r.empty()) return Error{ErrorCode::kUnsupported, r.front()};
        const AreaLightDescription& light = scene.area_lights[shape.area_light];
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
        } else {
            const double radius = shape.radius * length(shape.to_world.x), area = 4 * std::numbers::pi * radius * radius;
            emitter.is_sphere = true;
            emitter.p = Vec3f(shape.to_world.t);
            emitter.radius = static_cast<float>(radius);
            emitter.inward = shape.flip_normal;
            emitter.area = static_cast<float>(area);
            emitter.scale = scale(area);
            emitters_.push_back(emitter);
        }
    }
    return {};
}

}  // namespace latent::render
