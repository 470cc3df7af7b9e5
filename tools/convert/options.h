// tools/convert/options.h: what a print is asked to be, and what came of it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "color/print.h"
#include "image/rect.h"
#include "tools/convert/white.h"

namespace latent::convert {

enum class Depth : std::uint8_t { kDefault, k8, k16, kFloat };

struct ConvertOptions {
    std::filesystem::path input;
    std::vector<std::filesystem::path> outputs;  // the format is the extension's

    double sensitivity = 1;  // sigma; pushed by `stops`
    double stops = 0;
    bool auto_exposure = false;  // sigma from the picture; then pushed by `stops`
    std::string tone = "film";
    std::string gamut = "luminance";
    std::string profile = "srgb";
    std::optional<std::array<double, 3>> luminance_row;
    std::optional<White> white;      // printed neutral; unless given, the picture's own white
    std::string adapt = "bradford";  // from that white to the display's

    Depth depth = Depth::kDefault;    // 8 for display files, float for EXR; only what the format holds is accepted
    bool dither = true;               // of 8 bits
    std::optional<image::Rect> crop;  // in the coordinates of the display window
    int level = 0;                    // mip level of the input
    int dpi = 300;                    // pixels per inch: how large the print is on paper

    int quality = 90;        // of JPEG
    int png_level = 1;       // of zlib, in PNG and TIFF
    bool tiles = false;      // TIFF
    bool pyramid = false;    // TIFF
    bool png_tiles = false;  // Deep Zoom
    int overlap = 1;         // Deep Zoom

    int threads = 0;
    std::uint64_t memory = std::uint64_t{1} << 30;
    bool replace = false;
};

// Of the pixels, in percent.
inline constexpr std::array kPercentiles{1, 10, 50, 90, 99};

struct ConvertReport {
    int width = 0, height = 0;
    double sigma = 1;
    std::string profile, gamut, tone, adapt;
    color::Chromaticity white;  // that was printed neutral
    color::PrintReport print;
    std::array<double, kPercentiles.size()> luminance{};  // in the scene, at these percentiles; after adaptation
    std::uint64_t black = 0, burnt = 0;                   // pixels whose grey would be code 0 or 255 of 8 bits
    std::vector<std::string> outputs;
    double seconds = 0;

    // Pixels that were not numbers and stand for a fault upstream.
    std::uint64_t damaged() const { return print.nan + print.infinite + print.colourless; }
};

}  // namespace latent::convert
