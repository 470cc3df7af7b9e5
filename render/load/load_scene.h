// render/load/load_scene.h: a scene file (pbrt-v4, glTF 2.0, OBJ), with all that it names, becomes a SceneDescription.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/result.h"
#include "render/load/model/options.h"
#include "render/scene/description.h"

namespace latent::render {

struct LoadedScene {
    SceneDescription description;
    std::vector<File> embedded{};       // pictures that textures find as long as these are open
    std::vector<std::string> warnings;  // "room.pbrt:3:1: ...": what was ignored
    std::vector<std::string> notes;     // the same of what no sample depends on
    std::vector<std::string> added;     // "model.obj: has no light; ...": what a model lacked
};

// Errors: kNotFound, kIo; kCorrupt for a syntax error; kUnsupported if anything was found that would make the picture wrong: the
// message then holds one line for each, all of them.
//
// With `replace_integrator`, that of a pbrt scene is replaced: whatever its name is, the picture is as asked. `rgb_spectra` says
// what the colours of the scene stand for. `model` is for glTF and OBJ: kUsage if a pbrt scene is given any of it. `additions` are
// files of pbrt's: what they hold is added to the scene, in its coordinates (model/append.h).
Result<LoadedScene> load_scene(const std::filesystem::path& path, bool replace_integrator = false,
                               color::RgbSpectra rgb_spectra = color::RgbSpectra::kSmooth, const ModelOptions& model = {},
                               const std::vector<std::filesystem::path>& additions = {});

}  // namespace latent::render
