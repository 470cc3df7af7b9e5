// render/load/pbrt/environment_image.h: EXR files in pbrt's equal-area octahedral mapping.
#pragma once

#include <memory>
#include <string>

#include "render/load/files/scene_files.h"
#include "render/load/pbrt/parameters.h"
#include "render/scene/description.h"

namespace latent::render {

// Errors and warnings go to the lists' diagnostics; what is returned is then of no use, but valid.

// The environment image `name`, as linear sRGB; null if an error was reported.
std::shared_ptr<const ImageDescription> read_environment(const ParameterList& list, const std::string& name, SceneFiles& files);

}  // namespace latent::render
