// render/load/obj/mtl.h: the materials of an MTL file. docs/models.md, "OBJ".
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
    double radiance = 0;   // the largest component of its emission
    FloatInput alpha = 1;  // for its shapes
};
using MtlMaterials = std::map<std::string, MtlMaterial, std::less<>>;

// Where the materials of an MTL file go, and what their colours are made with.
struct MtlTarget {
    SceneFiles& files;
    const ModelColors& colors;
    Diagnostics& diagnostics;
    std::vector<TextureDescription>& textures;  // which materials refer to by index
    bool by_vertex_color = false;               // diffuse colours are multiplied by the colours of vertices
};

// `text` is that of file `name`, as the OBJ file names it. A material that exists is defined anew. False: the text is not
// that of an MTL file, and no part of it is in a message.
bool read_mtl(std::string_view text, const std::string& name, const MtlTarget& target, MtlMaterials& materials);

}  // namespace latent::render
