// render/load/obj/obj.h: a Wavefront OBJ file, with its MTL files, becomes a model [Wavefront]. docs/models.md, "OBJ".
#pragma once

#include <string>
#include <string_view>

#include "render/load/files/diagnostics.h"
#include "render/load/files/scene_files.h"
#include "render/load/model/colors.h"
#include "render/load/model/model.h"

namespace latent::render {

// `text` is that of the file; `name` begins every message. What is wrong goes to `diagnostics`.
Model read_obj(std::string_view text, const std::string& name, SceneFiles& files, const ModelColors& colors,
               Diagnostics& diagnostics);

}  // namespace latent::render
