// render/load/gltf/meshes.h: the triangles of a glTF file [glTF2 3.7.2].
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/load/gltf/document.h"
#include "render/load/gltf/materials.h"
#include "render/load/mesh/placement.h"

namespace latent::render {

// In the space of its mesh. Texture coordinates have v upwards, as pbrt's do.
struct GltfPrimitive {
    LoadedMesh mesh{};
    std::uint32_t material = kNone;  // index into /materials
};

// How a mesh is bent: by its morph targets, then by the joints of a skin.
struct GltfPose {
    std::vector<double> weights{};  // one for each target; those that are missing are 0
    std::vector<Affined> joints{};  // a skin's, from the space of the mesh to the world; empty: none
};

// What a mesh needs to know about materials.
struct GltfMaterialLookup {
    std::function<std::uint32_t(const GltfValue& primitive)> material_of;  // index into /materials, or kNone
    std::function<const VertexNeeds&(std::uint32_t material)> needs_of;
};

// The primitives of /meshes/N that have triangles.
std::vector<GltfPrimitive> read_mesh(const GltfDocument& document, const GltfValue& mesh, const GltfPose& pose,
                                     const GltfMaterialLookup& materials);

}  // namespace latent::render
