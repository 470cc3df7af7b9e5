// tools/convert/source.h: the developed picture that is printed: its pixels, what they mean, and the part that is wanted.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "color/tristimulus.h"
#include "image/exr_reader.h"
#include "tools/convert/options.h"
#include "tools/convert/vignette.h"

namespace latent::convert {

struct Source {
    image::ExrReader reader;
    image::Rect area;              // the part to print, in the coordinates of the display window
    color::Matrix3 xyz_from_file;  // the identity for a file that holds XYZ
    color::Chromaticity white;     // what counts as white: the file's adopted neutral, else its white, else D65; or the observer's
    std::optional<double> cd_m2;   // luminance where Y = 1
    std::string observer{};        // that the pixels were made for; "": unknown
    std::vector<std::string> warnings{};
    std::optional<FallOff> fall_off{};  // light that the lens loses off its axis

    // As ExrReader::read, and with the fall-off.
    Status read(const image::Rect& area, const std::array<float*, 3>& planes, std::size_t row_stride,
                image::ExrReader::Scratch& scratch) const;
};

// Size of a pixel on a frame whose longer side is `frame_mm`.
double pixel_um(const Source& source, double frame_mm);

// Errors: those of ExrReader::open and of observers; kUsage for a crop beyond the pixels that the file holds, naming these, and for
// options that do not go with what it holds.
Result<Source> open_source(const ConvertOptions& options);

}  // namespace latent::convert
