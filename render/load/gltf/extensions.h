// render/load/gltf/extensions.h: the extensions of glTF 2.0 that are read.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "render/load/gltf/value.h"

namespace latent::render {

std::span<const std::string_view> known_extensions();
// Whether it is one of these, or changes no picture.
bool is_known_extension(std::string_view name);
// "is not supported, and is ignored", and why or what happens.
std::string unsupported_extension(std::string_view name);

// A note or a warning for each other extension that a document uses, an error for each that it requires. Returns false after an
// error: what the file holds instead is only in the extension.
bool check_extensions(const GltfValue& root);

}  // namespace latent::render
