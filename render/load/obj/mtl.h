// render/load/obj/mtl.h: the materials of an MTL file. docs/scenes.md, "OBJ".
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "render/load/files/diagnostics.h"
#include "render/load/files/scene_files.h"
#include "render/load/model/colors.h"
#include "render/scene/description.h"

namespace latent::render {

struct MtlMaterial {
    MaterialDescription surface{};
    std::optional<AreaLightDescription> emission{};
    double radiance = 0;   // of its emission: the largest component
    FloatInput alpha = 1;  // of its shapes
};
using MtlMaterials = std::map<std::string, MtlMaterial, std::less<>>;

// Of a file's text; `name` begins every message. A material that is there already is defined anew. Pictures become textures, which
// materials refer to by index.
void read_mtl(std::string_view text, const std::string& name, const SceneFiles& files, const ModelColors& colors,
              Diagnostics& diagnostics, MtlMaterials& materials, std::vector<TextureDescription>& textures);

}  // namespace latent::render
