// render/load/pbrt/materials.h: materials. Defaults are pbrt-v4's.
#pragma once

#include <optional>
#include <string>

#include "render/load/pbrt/parameters.h"
#include "render/load/pbrt/spectra.h"
#include "render/load/pbrt/textures.h"
#include "render/scene/description.h"

namespace latent::render {

// Errors and warnings go to the lists' diagnostics; what is returned is then of no use, but valid.

// Nothing: "interface", or an error was reported.
std::optional<MaterialDescription> read_material(const std::string& type, const ParameterList& list, SceneTextures& textures);

}  // namespace latent::render
