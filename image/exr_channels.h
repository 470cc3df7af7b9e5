// image/exr_channels.h: which channels of an OpenEXR file make a picture, and where they are in a row of pixels.
#pragma once

#include <openexr.h>

#include <array>
#include <filesystem>
#include <span>
#include <vector>

#include "image/exr_reader.h"

namespace latent::image {

// Bytes per pixel of the channels before it, which are in alphabetic order.
struct ExrChannel {
    std::size_t offset = 0;
    bool half = false;
};

struct ExrChannels {
    std::size_t pixel_bytes = 0;         // for all channels of the file
    bool has_colour = false;             // R, G, B; or X, Y, Z; or Y alone (grey)
    bool xyz = false;                    // X, Y, Z
    bool grey = false;                   // Y alone
    std::array<ExrChannel, 3> colour{};  // those of the three planes
    std::vector<ExrChannel> emitted{};   // those of a spectrum, by wavelength
    std::vector<double> emitted_nm{};
};

// Errors: kUnsupported if there is no picture in them; kUsage if there is no such layer.
Result<ExrChannels> find_exr_channels(const std::filesystem::path& path, std::span<const exr_attr_chlist_entry_t> entries,
                                      const ExrChoice& choice);

// Pixels of a channel as floats; the file is little-endian.
void load_channel(const std::byte* from, bool half, std::span<float> out);

}  // namespace latent::image
