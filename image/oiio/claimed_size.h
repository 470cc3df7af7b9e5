// image/oiio/claimed_size.h: how large a picture and its header say they are, before a library makes room for that.
#pragma once

#include <cstdint>
#include <filesystem>

namespace latent::image {

// Of JPEG, GIF and OpenEXR, whose libraries make room when a file is opened: pixels of the picture, or of a tile if that is larger.
// 0: of other formats, or what cannot be read. Of OpenEXR: whether an attribute is said to be longer than the rest of the file.
struct ClaimedSize {
    std::uint64_t width = 0, height = 0;
    bool attribute_overruns = false;
};
ClaimedSize claimed_size(const std::filesystem::path& path, std::uint64_t file_bytes);

}  // namespace latent::image
