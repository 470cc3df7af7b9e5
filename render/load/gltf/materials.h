// render/load/gltf/materials.h: the materials of a glTF file [glTF2 3.9] and the extensions of them that are supported.
// docs/models.md, "glTF".
#pragma once

#include <optional>
#include <vector>

#include "render/load/gltf/textures.h"
#include "render/load/model/colors.h"
#include "render/scene/description.h"

namespace latent::render {

// What its vertices must have.
struct VertexNeeds {
    std::vector<std::uint32_t> uv_sets{};  // the TEXCOORD_N of its textures; the first orients tangents
    bool tangents = false;
};

struct GltfMaterial {
    MaterialDescription surface{};
    std::optional<MaterialDescription> second{};  // what the surface is in part: glass, or what light passes diffusely
    FloatInput second_share{};                    // share of the surface that the second material has
    std::optional<AreaLightDescription> emission{};
    double radiance = 0;                        // the largest component of its emission
    std::optional<MediumDescription> inside{};  // KHR_materials_volume, where it absorbs
    FloatInput alpha = 1;                       // for its shapes
    VertexNeeds needs{};
};

// /materials/N; the default material if there is no such value. `vertices`: what primitives of it have.
GltfMaterial read_material(const GltfValue& material, VertexColors vertices, const ModelColors& colors, GltfTextures& textures);

}  // namespace latent::render
