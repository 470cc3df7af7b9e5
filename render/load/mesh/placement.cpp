#include "render/load/mesh/placement.h"

#include <algorithm>
#include <tuple>

#include "render/math/motion.h"

namespace latent::render {
namespace {

void add(const LoadedShape& loaded, Box& box) {
    if (loaded.mesh) {
        const LoadedMesh& mesh = *loaded.mesh;
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            const Vec3d &p = mesh.positions[i], reach = Vec3d(1, 1, 1) * (mesh.radii.empty() ? 0 : mesh.radii[i]);
            box.add(p - reach);
            box.add(p + reach);
        }
    } else {
        const Box quadric = quadric_box(loaded.shape);
        box.add(quadric.low);
        box.add(quadric.high);
    }
}

void add(const Affined& map, const Box& from, Box& box) {
    if (from.is_empty()) return;
    for (const double x : {from.low.x, from.high.x}) {
        for (const double y : {from.low.y, from.high.y}) {
            for (const double z : {from.low.z, from.high.z}) box.add(map.point({x, y, z}));
        }
    }
}

// Seen from `origin`, rounded once.
ShapeDescription placed(LoadedShape loaded, const Vec3d& origin) {
    if (!loaded.mesh) {
        loaded.shape.to_world.t += -origin;
    } else {
        MeshDescription mesh{.normals = std::move(loaded.mesh->normals),
                             .tangents = std::move(loaded.mesh->tangents),
                             .bitangents = std::move(loaded.mesh->bitangents),
                             .uvs = std::move(loaded.mesh->uvs),
                             .more_uvs = std::move(loaded.mesh->more_uvs),
                             .colors = std::move(loaded.mesh->colors),
                             .radii{loaded.mesh->radii.begin(), loaded.mesh->radii.end()},
                             .indices = std::move(loaded.mesh->indices)};
        mesh.positions.reserve(loaded.mesh->positions.size());
        for (const Vec3d& p : loaded.mesh->positions) mesh.positions.emplace_back(p - origin);
        loaded.shape.mesh = std::make_shared<MeshDescription>(std::move(mesh));
    }
    return std::move(loaded.shape);
}

std::vector<Box> boxes_of(const std::vector<std::vector<LoadedShape>>& objects) {
    std::vector<Box> boxes(objects.size());
    for (std::size_t i = 0; i < objects.size(); ++i) {
        for (const LoadedShape& shape : objects[i]) add(shape, boxes[i]);
    }
    return boxes;
}

Box box_about(const std::vector<LoadedShape>& shapes, const std::vector<Box>& of_object,
              const std::vector<InstanceDescription>& instances) {
    Box world;
    for (const LoadedShape& shape : shapes) add(shape, world);
    for (const InstanceDescription& instance : instances) {
        for (const Affined& map : moments_of(instance)) add(map, of_object[instance.object], world);
    }
    return world;
}

bool have_the_same_surface(const ShapeDescription& a, const ShapeDescription& b) {
    const auto surface = [](const ShapeDescription& s) {
        return std::tuple(s.flip_normal, s.alpha.value, s.alpha.texture, s.material, s.area_light, s.inside_medium,
                          s.outside_medium);
    };
    return surface(a) == surface(b);
}

}  // namespace

void add_shape(LoadedShape shape, std::vector<LoadedShape>& shapes) {
    const bool joins = shape.shape.kind == ShapeKind::kTube && !shapes.empty() && shapes.back().shape.kind == ShapeKind::kTube &&
                       have_the_same_surface(shape.shape, shapes.back().shape);
    if (!joins) return shapes.push_back(std::move(shape));
    LoadedMesh &more = *shape.mesh, &mesh = *shapes.back().mesh;
    const auto before = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t& first : more.indices) first += before;
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(mesh.positions, more.positions);
    append(mesh.radii, more.radii);
    append(mesh.normals, more.normals);
    append(mesh.indices, more.indices);
}

std::vector<Affined> moments_of(const InstanceDescription& instance) {
    std::vector<Affined> out = {instance.world_from_object};
    if (!instance.end) return out;
    const Motion motion(instance.world_from_object, *instance.end);
    for (int i = 1; i <= 16; ++i) out.push_back(motion.at(i / 16.0));
    return out;
}

Box box_of(const std::vector<LoadedShape>& shapes, const std::vector<std::vector<LoadedShape>>& objects,
           const std::vector<InstanceDescription>& instances) {
    return box_about(shapes, boxes_of(objects), instances);
}

void place(std::vector<LoadedShape> shapes, std::vector<std::vector<LoadedShape>> objects, SceneDescription& scene) {
    const bool has_vertex_colors = std::ranges::any_of(scene.textures, [](const TextureDescription& texture) {
        return texture.kind == TextureKind::kVertexColor || texture.by_vertex_color;
    });
    if (!has_vertex_colors) {
        const auto drop = [](std::vector<LoadedShape>& list) {
            for (LoadedShape& shape : list) {
                if (shape.mesh) shape.mesh->colors = {};
            }
        };
        drop(shapes);
        std::ranges::for_each(objects, drop);
    }
    const std::vector<Box> of_object = boxes_of(objects);
    const Box world = box_about(shapes, of_object, scene.instances);

    const Vec3d& camera = scene.camera.world_from_camera.t;
    scene.origin = world.is_empty() ? camera : world.nearest(camera);
    scene.camera.world_from_camera.t += -scene.origin;
    if (scene.camera.end) scene.camera.end->t += -scene.origin;
    for (LightDescription& light : scene.lights) {
        light.world_from_light.t += -scene.origin;
        if (!light.portal) continue;
        for (Vec3d& corner : *light.portal) corner += -scene.origin;
    }
    for (TextureDescription& texture : scene.textures) {
        Affined& map = texture.mapping.texture_from_world;
        map.t = map.point(scene.origin);
    }
    for (MediumDescription& medium : scene.media) {
        if (!std::holds_alternative<UniformVolume>(medium.volume)) medium.world_from_medium.t += -scene.origin;
    }
    for (LoadedShape& shape : shapes) scene.shapes.push_back(placed(std::move(shape), scene.origin));
    for (std::size_t i = 0; i < objects.size(); ++i) {
        ObjectDescription& object = scene.objects[i];
        if (!of_object[i].is_empty()) object.origin = of_object[i].middle();
        for (LoadedShape& shape : objects[i]) object.shapes.push_back(placed(std::move(shape), object.origin));
    }
    for (InstanceDescription& instance : scene.instances) {
        const auto move = [&](Affined& map) { map.t = map.point(scene.objects[instance.object].origin) - scene.origin; };
        move(instance.world_from_object);
        if (instance.end) move(*instance.end);
    }
}

}  // namespace latent::render
