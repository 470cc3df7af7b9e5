#include "render/geometry/emitters.h"

#include "render/geometry/surface.h"
#include "render/scene/check.h"
#include "render/scene/quadric.h"

namespace latent::render {

Result<std::vector<Emitter>> find_emitters(std::vector<PlacedShape>& shapes) {
    std::vector<Emitter> emitters;
    for (PlacedShape& placed : shapes) {
        const ShapeDescription& shape = placed.shape;
        if (shape.area_light == kNone) continue;
        if (const Refusals r = check_area_light(shape); !r.empty()) return Error{ErrorCode::kUnsupported, r.front()};
        placed.first_emitter = static_cast<std::uint32_t>(emitters.size());
        Emitter emitter{.area_light = shape.area_light,
                        .shape = static_cast<std::uint32_t>(&placed - shapes.data()),
                        .inside_medium = shape.inside_medium,
                        .outside_medium = shape.outside_medium};
        if (shape.kind == ShapeKind::kTriangles) {
            const MeshDescription& mesh = *shape.mesh;
            for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
                emitter.primitive = static_cast<std::uint32_t>(i / 3);
                const SurfaceHit hit = surface_at(placed, emitter.primitive, {1 / 3.0f, 1 / 3.0f}, {});
                emitter.p = mesh.positions[mesh.indices[i]];
                emitter.e1 = mesh.positions[mesh.indices[i + 1]] - emitter.p;
                emitter.e2 = mesh.positions[mesh.indices[i + 2]] - emitter.p;
                emitter.area = 0.5 * length(cross(Vec3d(emitter.e1), Vec3d(emitter.e2)));
                emitter.n = emitter.area > 0 ? hit.ng : Vec3f{};
                emitter.is_half = shape.pairs;
                emitters.push_back(emitter);
            }
        } else {
            const double scale = length(shape.to_world.x);
            emitter.kind = is_whole_sphere(shape) ? EmitterKind::kSphere : EmitterKind::kQuadric;
            emitter.p = Vec3f(shape.to_world.t);
            emitter.radius = static_cast<float>(shape.radius * scale);
            emitter.inward = shape.flip_normal;
            emitter.area =
                quadric_area(shape) * (is_stretched(shape) ? length(cross(shape.to_world.x, shape.to_world.y)) : scale * scale);
            emitters.push_back(emitter);
        }
    }
    return emitters;
}

}  // namespace latent::render
