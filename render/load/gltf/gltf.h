// render/load/gltf/gltf.h: a glTF 2.0 file, .gltf or .glb, becomes a model [glTF2]. docs/models.md, "glTF".
#pragma once

#include <string>

#include "base/result.h"
#include "render/load/files/diagnostics.h"
#include "render/load/files/scene_files.h"
#include "render/load/model/colors.h"
#include "render/load/model/model.h"

namespace latent::render {

// `bytes`: the file's content; `name` begins every message. Of `options`, only camera and variant matter. What is
// wrong goes to `diagnostics` as far as the file can be read on. Errors: those of GltfDocument::read.
Result<Model> read_gltf(const std::string& bytes, const std::string& name, SceneFiles& files, const ModelColors& colors,
                        const ModelOptions& options, Diagnostics& diagnostics);

}  // namespace latent::render
