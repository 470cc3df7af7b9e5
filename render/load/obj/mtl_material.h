// render/load/obj/mtl_material.h: from the values of an MTL material to a surface, its opacity and its light. docs/models.md,
// "OBJ", has the same as a table.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "render/load/obj/maps.h"
#include "render/load/obj/mtl.h"

namespace latent::render {

// A newmtl block as it stands.
struct MtlBlock {
    std::string place, name;
    bool is_blenders = false;  // Blender wrote the file
    std::optional<LinearRgb> ka{}, kd{}, ks{}, ke{}, tf{};
    double ns = 20, ni = 1.5, opacity = 1;
    int illum = 2;
    std::optional<double> roughness{}, metallic{}, sheen{};
    double coat = 0, coat_roughness = 0;
    bool lacks_map_kd = false;                          // it names a picture that is missing, or cannot be read
    std::map<std::string, MtlMap, std::less<>> maps{};  // by keyword

    bool has(std::string_view keyword) const { return maps.contains(keyword); }
};

MtlMaterial describe(MtlBlock block, const MtlTarget& target);

}  // namespace latent::render
