// tests/convert/test_picture.h: developed pictures to print, written by OpenEXR's C++ library, and one call to print them.
#pragma once

#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "image/exr_reader.h"
#include "image/rect.h"
#include "tests/faults/process.h"
#include "tests/image/decode.h"
#include "tools/convert/convert.h"

namespace latent::convert {

// --profile of the light that table_space() holds.
inline constexpr const char* kTableSpace = "0.7347,0.2653,0.1596,0.8404,0.0366,0.0001,0.3457,0.3585";

struct PictureLayout {
    int width = 300, height = 200;
    image::Rect window{};  // data window; the whole picture if empty
    int tile = 0;
    bool zip = false;
    std::optional<std::array<float, 8>> chromaticities = std::array<float, 8>{1, 0, 0, 1, 0, 0, 1 / 3.0f, 1 / 3.0f};
    std::array<const char*, 3> channels{"R", "G", "B"};
    std::optional<float> white_luminance{};
    std::map<std::string, std::string> texts{};  // attributes
};

using Light = std::function<std::array<float, 3>(int x, int y)>;

// Colours in and out of every gamut over a contrast of 2^10, another one in each pixel.
inline std::array<float, 3> colourful(int x, int y) {
    const double u = std::fmod(x * 0.618033988749895, 1.0), v = std::fmod(y * 0.754877666246693, 1.0);
    const double light = std::exp2(-6 + 10 * std::fmod(x * 0.0137 + y * 0.0071, 1.0));
    return {static_cast<float>(light * (0.2 + 1.6 * u)), static_cast<float>(light), static_cast<float>(light * (1.9 - 1.8 * v))};
}

inline void write_picture(const std::filesystem::path& path, const PictureLayout& layout, const Light& light = colourful) {
    const image::Rect window = layout.window.empty() ? image::Rect{0, 0, layout.width, layout.height} : layout.window;
    Imf::Header header(layout.width, layout.height);
    header.dataWindow() = {{window.x0, window.y0}, {window.x1 - 1, window.y1 - 1}};
    header.compression() = layout.zip ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION;
    if (layout.chromaticities) {
        const auto& c = *layout.chromaticities;
        Imf::addChromaticities(header, Imf::Chromaticities({c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}));
    }
    if (layout.channels[0] == std::string("X") || (layout.chromaticities && (*layout.chromaticities)[0] == 1))
        Imf::addAdoptedNeutral(header, {0.3127f, 0.3290f});
    if (layout.white_luminance) Imf::addWhiteLuminance(header, *layout.white_luminance);
    for (const auto& [name, text] : layout.texts) header.insert(name, Imf::StringAttribute(text));
    std::vector<float> pixels;
    for (int y = window.y0; y < window.y1; ++y) {
        for (int x = window.x0; x < window.x1; ++x) {
            for (const float value : light(x, y)) pixels.push_back(value);
        }
    }
    const std::size_t stride = 12 * static_cast<std::size_t>(window.width());
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < 3; ++c) {
        header.channels().insert(layout.channels[c], Imf::Channel(Imf::FLOAT));
        char* base = reinterpret_cast<char*>(pixels.data()) + 4 * c - 12 * static_cast<std::ptrdiff_t>(window.x0) -
                     static_cast<std::ptrdiff_t>(stride) * window.y0;
        frame.insert(layout.channels[c], Imf::Slice(Imf::FLOAT, base, 12, stride));
    }
    if (layout.tile > 0) {
        header.setTileDescription({static_cast<unsigned>(layout.tile), static_cast<unsigned>(layout.tile), Imf::ONE_LEVEL});
        header.lineOrder() = Imf::RANDOM_Y;
        Imf::TiledOutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame);
        for (int y = file.numYTiles() - 1; y >= 0; --y) {
            for (int x = 0; x < file.numXTiles(); ++x) file.writeTile(x, y);
        }
    } else {
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(window.height());
    }
}

// A folder with a picture in it, gone after the test.
class PrintTest : public ::testing::Test {
 protected:
    testing::TemporaryFolder folder_;
    std::string at(const std::string& name) const { return (folder_ / name).string(); }

    Result<ConvertReport> print(const std::string& input, const std::string& output, ConvertOptions options = {}) const {
        if (!options.auto_exposure && !options.key) options.sensitivity = options.sensitivity.value_or(1);
        options.input = folder_ / input;
        options.outputs = {folder_ / output};
        return convert(options, {});
    }
    // Three planes of what is printed without a tone curve, for primaries that are those of XYZ.
    std::vector<float> light(const std::string& input, const std::string& output, ConvertOptions options) const {
        options.tone = "none";
        options.profile = "1,0,0,0,1,0,0,0,1";
        const Result<ConvertReport> report = print(input, output, options);
        EXPECT_TRUE(report) << (report ? "" : report.error().message);
        if (!report) return {};
        const Result<image::ExrReader> reader = image::ExrReader::open(folder_ / output);
        EXPECT_TRUE(reader);
        const image::Rect window = reader->image().data_window;
        std::vector<float> pixels(3 * window.pixels());
        image::ExrReader::Scratch scratch;
        EXPECT_TRUE(reader->read(window, {&pixels[0], &pixels[window.pixels()], &pixels[2 * window.pixels()]},
                                 static_cast<std::size_t>(window.width()), scratch));
        return pixels;
    }
    testing::Outcome run_tool(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), testing::tool("latent-convert"));
        return testing::run(arguments);
    }
};

}  // namespace latent::convert
