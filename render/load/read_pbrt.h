// render/load/read_pbrt.h: a scene for pbrt, with all that it includes. docs/scenes.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "color/rgb_basis.h"
#include "render/load/files/diagnostics.h"
#include "render/load/model/model.h"
#include "render/load/pbrt/options.h"

namespace latent::render {

// `names` are those of the files that `diagnostics` refers to: this one's are added. Errors: those of load_scene.
Result<Model> read_pbrt(const std::filesystem::path& path, const PbrtUse& use, color::RgbSpectra rgb_spectra,
                        std::vector<std::string>& names, Diagnostics& diagnostics);

}  // namespace latent::render
