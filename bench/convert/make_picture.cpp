// latent-make-picture OUT.exr WIDTH HEIGHT [rows|tiles] [none|zip]: a developed picture of any size, in little memory, to convert.
// XYZ floats: colours that drift over a contrast of 2^7, with 3 % of grain in every pixel; some colours are out of sRGB's gamut.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
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

void fill(std::vector<float>& row, int width, int height, int y) {
    const float v = static_cast<float>(y) / static_cast<float>(height);
    const float exposure = std::exp2(-5 + 7 * v);
    for (int x = 0; x < width; ++x) {
        const float u = static_cast<float>(x) / static_cast<float>(width);
        const float grain =
            static_cast<float>(hash(static_cast<std::uint32_t>(x) * 2654435761u + hash(static_cast<std::uint32_t>(y)))) * 0x1p-32f;
        const float light = exposure * (0.97f + 0.06f * grain) * (0.75f + 0.25f * std::sin(40 * u + 23 * v));
        float* pixel = row.data() + 3 * static_cast<std::size_t>(x);
        pixel[0] = light * (0.6f + 0.8f * u);
        pixel[1] = light;
        pixel[2] = light * (1.6f - 1.3f * u + 0.3f * std::cos(11 * v));
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        fmt::print(stderr, "latent-make-picture OUT.exr WIDTH HEIGHT [rows|tiles] [none|zip]\n");
        return 2;
    }
    const int width = std::stoi(argv[2]), height = std::stoi(argv[3]);
    const bool tiles = argc > 4 && std::string(argv[4]) == "tiles", zip = argc > 5 && std::string(argv[5]) == "zip";
    Imf::Header header(width, height);
    header.compression() = zip ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION;
    for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    Imf::addChromaticities(header, Imf::Chromaticities({1, 0}, {0, 1}, {0, 0}, {1 / 3.0f, 1 / 3.0f}));
    Imf::addAdoptedNeutral(header, {0.3127f, 0.3290f});
    const int step = tiles ? 256 : 16;
    std::vector<float> rows(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(step)),
        row(3 * static_cast<std::size_t>(width));
    const auto frame = [&](int y0) {
        Imf::FrameBuffer buffer;
        const char* names[] = {"R", "G", "B"};
        const std::size_t stride = row.size() * sizeof(float);
        char* base = reinterpret_cast<char*>(rows.data()) - static_cast<std::ptrdiff_t>(stride) * y0;
        for (std::size_t c = 0; c < 3; ++c) buffer.insert(names[c], Imf::Slice(Imf::FLOAT, base + 4 * c, 12, stride));
        for (int y = y0; y < std::min(height, y0 + step); ++y) {
            fill(row, width, height, y);
            std::copy(row.begin(), row.end(), rows.begin() + static_cast<std::ptrdiff_t>(row.size()) * (y - y0));
        }
        return buffer;
    };
    if (tiles) {
        header.setTileDescription({256, 256, Imf::ONE_LEVEL});
        header.lineOrder() = Imf::RANDOM_Y;
        Imf::TiledOutputFile file(argv[1], header, 0);
        for (int y = 0; y < file.numYTiles(); ++y) {
            file.setFrameBuffer(frame(y * step));
            file.writeTiles(0, file.numXTiles() - 1, y, y);
        }
    } else {
        Imf::OutputFile file(argv[1], header, 0);
        for (int y = 0; y < height; y += step) {
            file.setFrameBuffer(frame(y));
            file.writePixels(std::min(step, height - y));
        }
    }
    return 0;
}
