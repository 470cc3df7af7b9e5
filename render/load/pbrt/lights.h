// render/load/pbrt/lights.h: lights. Defaults are pbrt-v4's.
#pragma once

#include <string>

#include "render/load/files/scene_files.h"
#include "render/load/pbrt/parameters.h"
#include "render/load/pbrt/spectra.h"
#include "render/load/pbrt/textures.h"
#include "render/scene/description.h"

namespace latent::render {

// Errors and warnings go to the lists' diagnostics; what is returned is then of no use, but valid.

LightDescription read_light(const std::string& type, const ParameterList& list, SceneSpectra& spectra, SceneFiles& files);
AreaLightDescription read_area_light(const std::string& type, const ParameterList& list, SceneSpectra& spectra,
                                     SceneTextures& textures, SceneFiles& files);

}  // namespace latent::render
