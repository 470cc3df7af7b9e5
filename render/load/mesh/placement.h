// render/load/mesh/placement.h: from vertices in double, wherever in the world they are, to floats about an origin that is near.
// docs/scenes.md, "Geometry".
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/scene/bounds.h"
#include "render/scene/description.h"

namespace latent::render {

// MeshDescription, in the space of the world or of the object that it belongs to.
struct LoadedMesh {
    std::vector<Vec3d> positions{};
    std::vector<Vec3f> normals{}, tangents{}, bitangents{};
    std::vector<Vec2f> uvs{};
    std::vector<std::vector<Vec2f>> more_uvs{};
    std::vector<std::array<float, 4>> colors{};
    std::vector<double> radii{};
    std::vector<std::uint32_t> indices{};
};
struct LoadedShape {
    ShapeDescription shape;            // without a mesh
    std::optional<LoadedMesh> mesh{};  // nothing: a quadric
};

// Adds `shape` to the list: tubes to the last shape, if that consists of tubes with the same surface, since hair has very many.
void add_shape(LoadedShape shape, std::vector<LoadedShape>& shapes);

// From the object to the world: where it stands, or 17 moments of its motion.
std::vector<Affined> moments_of(const InstanceDescription& instance);

// About all shapes of the world and all instances of objects, wherever they move.
Box box_of(const std::vector<LoadedShape>& shapes, const std::vector<std::vector<LoadedShape>>& objects,
           const std::vector<InstanceDescription>& instances);

// Gives the scene its shapes, and its objects theirs (one list for each), when all is read. Every place is counted
// from SceneDescription::origin from then on: the camera's place, or the point nearest to it of the box about all shapes, if it is
// outside. Colours of vertices go if no texture is made of them. Objects are counted from the middle of their own boxes, wherever
// they were modelled.
void place(std::vector<LoadedShape> shapes, std::vector<std::vector<LoadedShape>> objects, SceneDescription& scene);

}  // namespace latent::render
