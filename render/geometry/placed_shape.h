// render/geometry/placed_shape.h: the shapes and instances of a scene as rays meet them.
#pragma once

#include <vector>

#include "render/geometry/exact_shapes.h"
#include "render/geometry/geometry.h"

namespace latent::render {

// One shape as geometry; Embree's user data points to it.
struct PlacedShape {
    ShapeDescription shape;
    Affined from_world{};                 // quadrics
    QuadricPart part{};                   // of them
    std::uint32_t first_emitter = kNone;  // of its primitives

    bool is_whole() const { return !shape.alpha.is_textured() && shape.alpha.value >= 1; }
    bool is_invisible() const { return is_nowhere(shape.alpha); }
};

struct PlacedInstance {
    const std::vector<PlacedShape>* shapes;
    Affined world_from_object, object_from_world;
    float error_factor;  // error of a point per its size, from Embree's float transformation of the ray
};

struct PlacedWorld {
    std::vector<PlacedShape> shapes{};                // of the world
    std::vector<std::vector<PlacedShape>> objects{};  // of each
    std::vector<PlacedInstance> instances{};          // their numbers follow those of the world's shapes
    const Opacity* opacity = nullptr;

    const PlacedShape& shape(const PrimitivePoint& on) const {
        return on.instance == kNone ? shapes[on.shape] : (*instance(on).shapes)[on.shape];
    }
    const PlacedInstance& instance(const PrimitivePoint& on) const { return instances[on.instance - shapes.size()]; }
};

inline PatchCorners patch_corners(const MeshDescription& mesh, std::uint32_t primitive) {
    const std::uint32_t* v = &mesh.indices[4 * std::size_t{primitive}];
    return {Vec3d(mesh.positions[v[0]]), Vec3d(mesh.positions[v[1]]), Vec3d(mesh.positions[v[2]]), Vec3d(mesh.positions[v[3]])};
}

}  // namespace latent::render
