#include "tools/darkroom/server/bitmap.h"

#include <cstdint>

namespace latent::darkroom {

namespace {

constexpr std::size_t kFileHeader = 14, kInfoHeader = 124, kPixels = kFileHeader + kInfoHeader;

void put(std::string& to, std::size_t at, std::uint32_t value, std::size_t bytes = 4) {
    for (std::size_t i = 0; i < bytes; ++i) to[at + i] = static_cast<char>(value >> (8 * i) & 0xff);
}

}  // namespace

std::string bitmap_of(const convert::CodeValues& codes) {
    const auto width = static_cast<std::size_t>(codes.width), height = static_cast<std::size_t>(codes.height);
    const auto channels = static_cast<std::size_t>(codes.channels);
    const std::size_t stride = (3 * width + 3) / 4 * 4, profile = codes.srgb ? 0 : codes.icc.size();
    std::string file(kPixels + stride * height, '\0');
    file[0] = 'B', file[1] = 'M';
    put(file, 2, static_cast<std::uint32_t>(file.size() + profile));
    put(file, 10, kPixels);
    put(file, 14, kInfoHeader);
    put(file, 18, static_cast<std::uint32_t>(codes.width));
    put(file, 22, static_cast<std::uint32_t>(-codes.height));  // rows from the top
    put(file, 26, 1, 2);
    put(file, 28, 24, 2);
    put(file, 34, static_cast<std::uint32_t>(stride * height));
    put(file, 70, profile > 0 ? 0x4d424544 : 0x73524742);  // 'MBED', 'sRGB'
    put(file, 122, 4);                                     // perceptual
    if (profile > 0) {
        put(file, 126, static_cast<std::uint32_t>(file.size() - kFileHeader));
        put(file, 130, static_cast<std::uint32_t>(profile));
    }
    for (std::size_t y = 0; y < height; ++y) {
        const std::byte* from = codes.codes.data() + y * width * channels;
        char* to = file.data() + kPixels + y * stride;
        for (std::size_t x = 0; x < width; ++x, from += channels) {
            for (std::size_t c = 0; c < 3; ++c) *to++ = static_cast<char>(from[(2 - c) % channels]);
        }
    }
    if (profile > 0) file.append(reinterpret_cast<const char*>(codes.icc.data()), profile);
    return file;
}

}  // namespace latent::darkroom
