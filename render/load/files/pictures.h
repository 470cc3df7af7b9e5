// render/load/files/pictures.h: whole pictures of lights, as linear sRGB.
#pragma once

#include <filesystem>

#include "base/result.h"
#include "render/scene/description.h"

namespace latent::render {

struct LoadedPicture {
    ImageDescription image{};
    std::size_t refused = 0;  // values that no light can have, and that count as 0
};
// Integers are encoded as sRGB. Errors: kNotFound, kCorrupt, kUnsupported.
Result<LoadedPicture> read_picture(const std::filesystem::path& path);

double mean_luminance(const ImageDescription& image);

}  // namespace latent::render
