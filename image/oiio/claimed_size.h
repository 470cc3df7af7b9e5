// image/oiio/claimed_size.h: how large a picture and its header say they are, before a library makes room for that.
#pragma once

#include <cstdint>
#include <filesystem>

namespace latent::image {

// Pixels of the picture, or of a tile if that is larger, as JPEG, GIF and OpenEXR files say: their libraries make room on opening.
// 0 for other formats and unreadable files. For OpenEXR also whether an attribute claims to be longer than the rest of the file.
struct ClaimedSize {
    std::uint64_t width = 0, height = 0;
    bool attribute_overruns = false;
};
ClaimedSize claimed_size(const std::filesystem::path& path, std::uint64_t file_bytes);

}  // namespace latent::image
