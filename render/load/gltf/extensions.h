// render/load/gltf/extensions.h: the extensions of glTF 2.0 that are read, or that change no picture.
#pragma once

#include <span>
#include <string_view>

#include "render/load/gltf/value.h"

namespace latent::render {

std::span<const std::string_view> known_extensions();
bool is_known_extension(std::string_view name);

// A warning for each other extension that a document uses, an error for each that it requires. Returns false after an error: what
// the file holds instead is only in the extension.
bool check_extensions(const GltfValue& root);

}  // namespace latent::render
