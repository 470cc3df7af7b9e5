// render/geometry/placed_shape.h: the shapes and instances of a scene as rays hit them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/geometry/exact_shapes.h"
#include "render/geometry/geometry.h"
#include "render/math/motion.h"

namespace latent::render {

// One shape as geometry; Embree's user data points to it.
struct PlacedShape {
    ShapeDescription shape;
    Affined from_world{};                 // quadrics
    QuadricPart part{};                   // the part of a quadric that is there
    std::uint32_t first_emitter = kNone;  // the emitter of its first primitive

    bool hollow = false;      // hair: rays pass it from inside, and the normals of a tube point outwards
    bool is_watched = false;  // a hit need not end the ray, or is to be noted: Embree asks about each

    bool has_holes() const { return shape.alpha.is_textured() || shape.alpha.value < 1; }
    bool parts_media() const { return shape.inside_medium != shape.outside_medium; }
    bool is_invisible() const { return (is_interface(shape.material) || is_nowhere(shape.alpha)) && !parts_media(); }
};

// The sum of what the vertices have, with one weight for each.
inline Vec3d weighted(const std::vector<Vec3f>& values, const std::uint32_t* vertices, std::span<const double> weights) {
    Vec3d out;
    for (std::size_t i = 0; i < weights.size(); ++i) out += Vec3d(values[vertices[i]]) * weights[i];
    return out;
}

struct PlacedInstance {
    PlacedInstance(const std::vector<PlacedShape>& shapes, const Affined& world_from_object);

    const std::vector<PlacedShape>* shapes;
    Affined world_from_object, object_from_world;
    float error_factor;  // error of a point per its size, from the ray in the object's space, which is of floats
};
struct MovingInstance {
    const std::vector<PlacedShape>* shapes;
    Motion motion;  // how world_from_object moves

    PlacedInstance at(float time) const { return {*shapes, motion.at(static_cast<double>(time))}; }
};

struct PlacedWorld {
    std::vector<PlacedShape> shapes{};                // those of the world
    std::vector<std::vector<PlacedShape>> objects{};  // those of each object
    std::vector<PlacedInstance> instances{};          // their numbers follow those of the world's shapes
    std::vector<MovingInstance> moving{};             // and then these
    const Opacity* opacity = nullptr;

    const PlacedShape& shape(const PrimitivePoint& on) const {
        if (on.instance == kNone) return shapes[on.shape];
        const std::size_t i = on.instance - shapes.size();
        return (*(i < instances.size() ? instances[i].shapes : moving[i - instances.size()].shapes))[on.shape];
    }
    // At the time of the point; made in `room` if it moves.
    const PlacedInstance& instance(const PrimitivePoint& on, std::optional<PlacedInstance>& room) const {
        const std::size_t i = on.instance - shapes.size();
        return i < instances.size() ? instances[i] : room.emplace(moving[i - instances.size()].at(on.time));
    }
};

inline PatchCorners patch_corners(const MeshDescription& mesh, std::uint32_t primitive) {
    const std::uint32_t* v = &mesh.indices[4 * std::size_t{primitive}];
    return {Vec3d(mesh.positions[v[0]]), Vec3d(mesh.positions[v[1]]), Vec3d(mesh.positions[v[2]]), Vec3d(mesh.positions[v[3]])};
}

}  // namespace latent::render
