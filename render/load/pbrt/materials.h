// render/load/pbrt/materials.h: materials. Defaults are pbrt-v4's.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/load/files/scene_files.h"
#include "render/load/pbrt/parameters.h"
#include "render/load/pbrt/spectra.h"
#include "render/load/pbrt/textures.h"
#include "render/scene/description.h"

namespace latent::render {

// Errors and warnings go to the lists' diagnostics; what is returned is then of no use, but valid.

// All that can be read, and "mix", which refers to others.
std::vector<std::string_view> material_types();
// "interface", or an old name of it: the surface scatters nothing.
bool is_interface(std::string_view type);

struct PbrtMaterial {
    MaterialDescription surface;
    // What it is instead, at this share of its points.
    std::optional<MaterialDescription> second{};
    FloatInput second_share{};
};
// Nothing: an interface, or an error was reported.
std::optional<PbrtMaterial> read_material(const std::string& type, const ParameterList& list, SceneTextures& textures,
                                          const SceneFiles& files);

}  // namespace latent::render
