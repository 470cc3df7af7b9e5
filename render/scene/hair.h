// render/scene/hair.h: which surfaces are hair. docs/rendering.md, "Hair".
#pragma once

#include "render/scene/description.h"

namespace latent::render {

// Whether material i of the scene is hair, or a mixture with hair.
inline bool is_hair(const std::vector<MaterialDescription>& materials, std::uint32_t i, int nested = 0) {
    if (i == kNone || nested > 64) return false;
    const MaterialDescription& material = materials[i];
    if (material.type == "mix")
        return is_hair(materials, material.mixed[0], nested + 1) || is_hair(materials, material.mixed[1], nested + 1);
    return material.type == "hair";
}

}  // namespace latent::render
