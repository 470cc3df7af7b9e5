// tools/convert/options.h: what a print is asked to be, and what came of it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "base/result.h"
#include "color/auto_exposure.h"
#include "color/print.h"
#include "color/quantise.h"
#include "image/rect.h"
#include "tools/convert/camera_exposure.h"
#include "tools/convert/darkroom.h"
#include "tools/convert/device.h"
#include "tools/convert/dodge.h"
#include "tools/convert/glare.h"
#include "tools/convert/inspection.h"
#include "tools/convert/vignette.h"
#include "tools/convert/white.h"

namespace latent::convert {

enum class Depth : std::uint8_t { kDefault, k8, k16, kFloat };

// What a PNG with 8 bits per channel would hold of a print.
struct CodeValues {
    int width = 0, height = 0, channels = 3;
    std::vector<std::byte> codes;  // row after row from the top, all channels of a pixel together
    bool srgb = true;              // these are code values of sRGB
    std::vector<std::byte> icc;    // profile of the display
};

struct ConvertOptions {
    std::filesystem::path input;
    std::shared_ptr<const File> picture;         // to read instead, an EXR file that has no name; errors call it `input`
    std::vector<std::filesystem::path> outputs;  // the format is the extension's
    std::shared_ptr<CodeValues> codes;           // gets the first print as well, or instead

    std::string layer;     // channels LAYER.R, LAYER.G, LAYER.B; "": those without a layer
    std::string observer;  // for spectral pictures: a name in the catalogue, or a CSV file; "": cie1931
    // What the pixels are in, whatever the file says: "xyz", or a name in color/rgb_space.h; "": as the file says.
    std::string input_space;

    std::optional<double> sensitivity;       // sigma, before `stops`; none: chosen from the picture, or 1 with tone "none"
    std::optional<CameraExposure> exposure;  // that sigma follows from
    bool auto_exposure = false;              // choose it with tone "none" too
    std::optional<double> key;               // the same, and the grey at which the mean prints; none: 0.18
    std::vector<double> stops{0};  // by which sigma is pushed; several: a print for each, with the stops in its file names
    std::string tone = "film";     // color/tone_curve.h, or none
    double contrast = 1, black = 0;
    std::string gamut = "luminance";
    std::string profile = "srgb";
    std::string proof;    // profile of another device, whose prints are shown; "": none
    Rendering rendering;  // for profiles with tables
    std::optional<std::array<double, 3>> luminance_row;
    std::optional<White> white;      // printed neutral; unless given, the picture's own white
    std::string adapt = "bradford";  // from that white to the display's

    std::optional<Vignette> vignette;  // that the light of the scene gets, and then
    std::optional<Glare> glare;
    std::vector<Dodge> dodges;  // light that parts of the print get
    DarkroomOptions darkroom;   // for pictures on film

    bool grey = false;                              // one channel, the luminance of the print
    Depth depth = Depth::kDefault;                  // 8 for display files, float for EXR; only what the format holds is accepted
    color::Dither dither = color::Dither::kRandom;  // for outputs of 8 bits
    bool show_clipped = false;                      // mark what is burnt, black or out of gamut
    bool gamut_report = false;                      // look for the largest shift of hue
    std::optional<image::Rect> crop;                // in the coordinates of the display window
    int level = 0;                                  // mip level of the input
    int dpi = 300;                                  // pixels per inch: how large the print is on paper
    double paper_width_mm = 0;                      // instead: its width; 0: not given

    int quality = 90;               // for JPEG
    int png_level = 1;              // zlib's, in PNG and TIFF
    bool tiles = false;             // TIFF
    bool pyramid = false;           // TIFF
    bool png_tiles = false;         // Deep Zoom
    int overlap = 1;                // Deep Zoom
    std::filesystem::path compare;  // another print's .dzi, for the page of a Deep Zoom; "": none

    int threads = 0;
    std::uint64_t memory = std::uint64_t{1} << 30;
    bool replace = false;
    std::string recipe;  // base/recipe.h, that prints keep, with that of the picture; "": none

    // A film is exposed whatever tone its print has.
    bool chooses_exposure() const {
        return auto_exposure || key || (!sensitivity && !exposure && (tone != "none" || !darkroom.paper.empty()));
    }
    bool paper_decides_tone() const { return !darkroom.paper.empty() && darkroom.paper != "scan"; }
};

// What is shown instead of the print: "a proof", "clipped", both; "": the print itself.
std::string shown_by(const ConvertOptions& options);

// Percentiles of the pixels.
inline constexpr std::array kPercentiles{1, 10, 50, 90, 99};

using Percentiles = std::array<double, kPercentiles.size()>;

struct ExposureReport {
    double stops = 0, sigma = 1;
    color::PrintReport print;
    HueShifts hue_shifts;  // with ConvertOptions::gamut_report
    std::vector<std::string> outputs;
};

struct PassReport {
    std::vector<ExposureReport> exposures;
    color::LuminanceHistogram luminance;  // Y of the printed pixels in the scene, before adaptation
};

struct ConvertReport : ExposureReport {  // the first exposure's
    std::vector<ExposureReport> others;
    int width = 0, height = 0;
    std::string profile, gamut, tone, adapt;
    std::string observer;                // "": unknown
    std::string film;                    // the film and its print; "": none
    std::string vignette, glare;         // as --vignette and --glare; "": none
    std::size_t dodged = 0;              // parts that got light of their own
    std::string shown;                   // shown_by()
    std::string proof;                   // name of the profile that is simulated; "": none
    std::optional<Rendering> rendering;  // for profiles with tables, and proofs
    std::vector<std::string> warnings, notes;
    int dpi = 0;  // that --paper-width gives; 0: not asked for
    double contrast = 1, black_point = 0;
    bool gamut_report = false;
    color::Chromaticity white;  // that was printed neutral
    Percentiles luminance{};
    bool chose_exposure = false;       // sigma, before stops, is `auto_sigma`
    std::optional<double> auto_sigma;  // what the whole picture suggests; none: it has no light, or only a part was read
    double seconds = 0;

    // Pixels that were not numbers and stand for a fault upstream.
    std::uint64_t damaged() const { return print.nan + print.infinite + print.colourless; }
};

// "-1,0,1": 1 to 16 different numbers from -100 to 100. Errors: kUsage.
Result<std::vector<double>> parse_stops(std::string_view text);

}  // namespace latent::convert
