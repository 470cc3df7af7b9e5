// render/load/gltf/check.h: whether a document is what glTF 2.0 says (schema.h).
#pragma once

#include "render/load/gltf/value.h"

namespace latent::render {

// The whole document: an error for each member that holds something else than it should, or is missing; a warning for each kind of
// unknown member, with near names. What is not read is not checked: "extras", animations, skins, unknown extensions.
// Returns false after an error: what follows from it would be told as another one.
bool check_gltf(const GltfValue& root);

}  // namespace latent::render
