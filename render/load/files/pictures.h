// render/load/files/pictures.h: whole pictures of lights, as linear sRGB.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "base/result.h"
#include "render/scene/description.h"

namespace latent::render {

struct LoadedPicture {
    ImageDescription image{};
    std::size_t refused = 0;  // values that no light can have, and that count as 0
};
// Integers are encoded as sRGB. Messages call it `in_messages`. Errors: kNotFound, kCorrupt, kUnsupported.
Result<LoadedPicture> read_picture(const std::filesystem::path& path, const std::string& in_messages);

// What the alpha of a picture of colours is: how much of a surface is there, or something else, such as its gloss. Then it is 0
// where the colours go on as a picture; what is meant to be hidden is plain. `kUnused`: 1 everywhere, or 0 everywhere, as programs
// write it that do not use it.
enum class AlphaUse : std::uint8_t { kUnused, kOpacity, kOther };
// Errors: those of read_picture.
Result<AlphaUse> alpha_use(const std::filesystem::path& path, const std::string& in_messages);

// Whether a picture has no alpha, or one that is 1 everywhere. False also if it cannot be opened.
bool is_opaque(const std::filesystem::path& path);

// Whether the colours of a picture are, on the whole, near (1/2, 1/2, 1), as those of a normal map: as they are stored, or as
// sRGB's curve decodes them, since some programs write normals as if they were colours. `kNothing` also if it cannot be read.
enum class NormalUse : std::uint8_t { kNothing, kAsStored, kAsSrgb };
NormalUse normal_use(const std::filesystem::path& path, const std::string& in_messages);

// The mean luminance of the picture times a factor for each of R, G and B.
double mean_luminance(const ImageDescription& image, const std::array<double, 3>& factor = {1, 1, 1});

}  // namespace latent::render
