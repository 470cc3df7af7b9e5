// image/oiio/claimed_size.h: how large a picture says it is, before a library makes room for that.
#pragma once

#include <cstdint>
#include <filesystem>

namespace latent::image {

// Of JPEG and OpenEXR, whose libraries make room when a file is opened: pixels of the picture, or of a tile if that is larger.
// 0: of other formats, or what cannot be read.
struct ClaimedSize {
    std::uint64_t width = 0, height = 0;
};
ClaimedSize claimed_size(const std::filesystem::path& path, std::uint64_t file_bytes);

}  // namespace latent::image
