// render/load/load_scene.h: a .pbrt file, with all that it includes, becomes a SceneDescription.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "render/scene/description.h"

namespace latent::render {

struct LoadedScene {
    SceneDescription description;
    std::vector<std::string> warnings;  // "room.pbrt:3:1: ...": what was ignored, though the picture is right without it
};

// Errors: kNotFound, kIo; kCorrupt for a syntax error; kUnsupported if anything was found that would make the picture wrong: the
// message then holds one line for each, all of them.
//
// With `replace_integrator`, that of the scene is replaced: whatever its name is, the picture is as asked.
Result<LoadedScene> load_scene(const std::filesystem::path& path, bool replace_integrator = false);

}  // namespace latent::render
