// render/load/scene_format.h: which language a scene file is written in.
#pragma once

#include <filesystem>
#include <string_view>

namespace latent::render {

enum class SceneFormat { kPbrt, kGltf, kObj };

// By the extension of the name or, if it is none of these formats', by how the text begins. pbrt if nothing is recognised.
SceneFormat scene_format(const std::filesystem::path& path, std::string_view beginning);

// "this is a USD scene", of text in which no directive of pbrt could be read; empty if nothing is recognised.
std::string_view foreign_format(std::string_view text);

}  // namespace latent::render
