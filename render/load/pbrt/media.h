// render/load/pbrt/media.h: media. Defaults are pbrt-v4's.
#pragma once

#include <string>

#include "render/load/files/scene_files.h"
#include "render/load/pbrt/parameters.h"
#include "render/load/pbrt/spectra.h"
#include "render/scene/description.h"

namespace latent::render {

// `world_from_medium`: the current transformation. Errors and warnings go to the list's diagnostics; what is returned is then of no
// use, but valid.
MediumDescription read_medium(const std::string& type, const ParameterList& list, const Affined& world_from_medium,
                              SceneSpectra& spectra, const SceneFiles& files);

}  // namespace latent::render
