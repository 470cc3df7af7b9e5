// bench/picture.h: 256 x 256 pictures of CIE XYZ, ours or pbrt-v4's, and their means over blocks.
#pragma once

#include "bench/exr.h"
#include "tests/transport/comparison.h"

namespace latent::bench {

constexpr std::size_t kSide = 256, kPixels = kSide * kSide, kBlock = 32;
using Picture = std::vector<std::array<double, 3>>;

// The pixels of an EXR of X, Y and Z, or of linear red, green and blue as pbrt-v4 makes them. Throws std::runtime_error.
inline Picture read_picture(const std::string& path) {
    // CIE XYZ of linear RGB by pbrt-v4's own D65 table.
    constexpr double kXyzFromRgb[3][3] = {
        {0.4124577, 0.3575758, 0.1804372}, {0.2126735, 0.7151516, 0.0721749}, {0.0193340, 0.1191919, 0.9503026}};
    const Planes planes = read_planes(path);
    if (planes.width != int{kSide} || planes.height != int{kSide}) throw std::runtime_error(path + ": not 256 x 256 pixels");
    const image::ExrImage& header = planes.header;
    const auto primaries = header.chromaticities;  // of the channels R, G, B that hold X, Y, Z
    const bool xyz = header.xyz || (primaries && (*primaries)[0] == 1 && (*primaries)[3] == 1 && (*primaries)[4] == 0);
    Picture picture(kPixels);
    for (std::size_t i = 0; i < kPixels; ++i) {
        for (std::size_t row = 0; row < 3; ++row) {
            for (std::size_t c = 0; c < 3; ++c) {
                const double weight = xyz ? (row == c ? 1 : 0) : kXyzFromRgb[row][c];
                picture[i][row] += weight * static_cast<double>(planes.channels[c][i]);
            }
        }
    }
    return picture;
}

inline std::size_t block_of(std::size_t pixel) { return pixel / kSide / kBlock * (kSide / kBlock) + pixel % kSide / kBlock; }

inline render::testing::Blocks blocks_of(const Picture& picture) {
    render::testing::Blocks blocks{kSide / kBlock, std::vector<std::array<double, 3>>(kPixels / kBlock / kBlock)};
    for (std::size_t i = 0; i < kPixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c) blocks.xyz[block_of(i)][c] += picture[i][c] / (kBlock * kBlock);
    }
    return blocks;
}

}  // namespace latent::bench
