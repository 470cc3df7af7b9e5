// render/load/pbrt/light_pictures.h: the pictures that lights name.
#pragma once

#include <memory>
#include <string>

#include "render/load/files/scene_files.h"
#include "render/load/pbrt/parameters.h"
#include "render/scene/description.h"

namespace latent::render {

// Null if an error was reported. Values that no light can have count as 0, with a warning.
std::shared_ptr<const ImageDescription> read_light_picture(const ParameterList& list, const std::string& name, SceneFiles& files);
// The same, as a square in pbrt's equal-area octahedral mapping; from longitude and latitude, too.
std::shared_ptr<const ImageDescription> read_environment(const ParameterList& list, const std::string& name, SceneFiles& files);

}  // namespace latent::render
