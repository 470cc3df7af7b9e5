// tests/image/decode.h: images read back by the libraries of their formats, which share no code with our writers' compression.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "image/row_writer.h"

namespace latent::image {

struct Decoded {
    PixelFormat format;
    Bytes pixels;  // interleaved grey, RGB, or CMYK with 0 for no ink, in the host's byte order
    Bytes icc;
    std::vector<std::pair<std::string, std::string>> texts;
    std::vector<std::string> chunks;                                  // PNG: their types in order
    bool srgb = false;                                                // PNG: there is an sRGB chunk
    std::optional<std::array<std::uint8_t, 4>> cicp;                  // PNG: what a cICP chunk holds
    double x_resolution = 0, y_resolution = 0;                        // as the file has it: 0 if it says nothing
    int resolution_unit = 0;                                          // of the format's own codes
    int luminance_sampling = 0;                                       // JPEG: 1 if colour is as fine as luminance
    bool tiled = false, big = false, reduced = false, dated = false;  // TIFF
};

// Failures to decode fail the test.
Decoded decode_png(const std::filesystem::path& path);
Decoded decode_jpeg(const std::filesystem::path& path);
// One entry for each image of the file.
std::vector<Decoded> decode_tiff(const std::filesystem::path& path);

}  // namespace latent::image
