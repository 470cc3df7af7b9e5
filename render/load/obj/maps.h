// render/load/obj/maps.h: the pictures of MTL materials, and the options before their names [Wavefront].
#pragma once

#include <optional>

#include "render/load/files/pictures.h"
#include "render/load/files/scene_files.h"
#include "render/load/model/values.h"
#include "render/load/obj/statements.h"

namespace latent::render {

struct MtlMap {
    TextureDescription texture{};                    // its kind is kImage
    PictureChannel channel = PictureChannel::kMean;  // -imfchan: of a number
    double strength = 1;                             // -bm: of a bump or normal map
    AlphaUse alpha = AlphaUse::kUnused;              // what its alpha is used for
};

// "map_Kd -s 2 2 1 -clamp on wood 1.png". The file is looked for in the folder of the MTL file, in that of the OBJ file, and in
// both without the folders of its name. Nothing, with a warning, if there is none, or if it cannot be read.
std::optional<MtlMap> read_map(const Statements& statement, const std::string& mtl_name, SceneFiles& files);

}  // namespace latent::render
