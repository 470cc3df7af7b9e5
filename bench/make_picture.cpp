// bench/make_picture.cpp: a picture of any size as latent-develop writes it (XYZ floats, tiles, uncompressed), in little memory.
//   make_picture OUT.exr WIDTH HEIGHT [FILM EI]
// Colours that drift over a contrast of 2^7, with 3 % of grain in every pixel; some are out of sRGB's gamut. With FILM, the same
// numbers are exposures of its layers, where 1 is that of a grey card.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace {

std::uint32_t hash(std::uint32_t h) {
    h = (h ^ h >> 16) * 0x7feb352du;
    h = (h ^ h >> 15) * 0x846ca68bu;
    return h ^ h >> 16;
}

void fill(float* pixel, int width, int height, int y) {
    const float v = static_cast<float>(y) / static_cast<float>(height);
    const float exposure = std::exp2(-5 + 7 * v);
    for (int x = 0; x < width; ++x) {
        const float u = static_cast<float>(x) / static_cast<float>(width);
        const float grain =
            static_cast<float>(hash(static_cast<std::uint32_t>(x) * 2654435761u + hash(static_cast<std::uint32_t>(y)))) * 0x1p-32f;
        const float light = exposure * (0.97f + 0.06f * grain) * (0.75f + 0.25f * std::sin(40 * u + 23 * v));
        pixel[0] = light * (0.6f + 0.8f * u);
        pixel[1] = light;
        pixel[2] = light * (1.6f - 1.3f * u + 0.3f * std::cos(11 * v));
        pixel += 3;
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4 && argc != 6) return fmt::print(stderr, "usage: make_picture OUT.exr WIDTH HEIGHT [FILM EI]\n"), 2;
    const bool on_film = argc == 6;
    const float scale = on_film ? 10 / std::stof(argv[5]) : 1;
    constexpr int kTile = 256;
    const int width = std::stoi(argv[2]), height = std::stoi(argv[3]);
    Imf::Header header(width, height);
    header.compression() = Imf::NO_COMPRESSION;
    header.setTileDescription({kTile, kTile, Imf::ONE_LEVEL});
    header.lineOrder() = Imf::RANDOM_Y;
    for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    if (on_film) {
        header.insert("latentFilm", Imf::StringAttribute(argv[4]));
        header.insert("latentExposureIndex", Imf::StringAttribute(argv[5]));
        header.insert("latentPush", Imf::StringAttribute("0"));
    } else {
        Imf::addChromaticities(header, Imf::Chromaticities({1, 0}, {0, 1}, {0, 0}, {1 / 3.0f, 1 / 3.0f}));
        Imf::addAdoptedNeutral(header, {0.3127f, 0.3290f});
    }
    Imf::TiledOutputFile file(argv[1], header, 0);
    std::vector<float> rows(3 * static_cast<std::size_t>(width) * kTile);
    const std::size_t row_size = 3 * static_cast<std::size_t>(width);
    for (int tile = 0; tile < file.numYTiles(); ++tile) {
        const int first = tile * kTile;
        for (int y = first; y < std::min(height, first + kTile); ++y)
            fill(&rows[row_size * static_cast<std::size_t>(y - first)], width, height, y);
        for (float& v : rows) v *= scale;
        Imf::FrameBuffer buffer;
        const std::size_t stride = row_size * sizeof(float);
        char* base = reinterpret_cast<char*>(rows.data()) - static_cast<std::ptrdiff_t>(stride) * first;
        const char* names[] = {"R", "G", "B"};
        for (std::size_t c = 0; c < 3; ++c) buffer.insert(names[c], Imf::Slice(Imf::FLOAT, base + 4 * c, 12, stride));
        file.setFrameBuffer(buffer);
        file.writeTiles(0, file.numXTiles() - 1, tile, tile);
    }
    return 0;
}
