// tools/convert/display.h: the display that a print is made for: its RGB space and how files say so.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "base/bytes.h"
#include "base/result.h"
#include "color/rgb_space.h"

namespace latent::convert {

struct Display {
    color::RgbSpace space;
    color::Chromaticity white;  // what the picture's white is adapted to
    Bytes icc;                  // a profile that says the same; carries no date
    bool srgb = false;
    std::optional<std::array<std::uint8_t, 4>> cicp;  // code points of ITU-T H.273 that say the same, if there are any
};

// `text`: a name ("srgb", "display-p3", "rec2020", "adobe-rgb"), 8 numbers "rx,ry,gx,gy,bx,by,wx,wy", 9 numbers,
// the matrix from XYZ to linear RGB row by row (both encoded like sRGB), or an ICC profile *.icc or *.icm of three primaries and a
// curve. `luminance_row` replaces the luminances m of the primaries; a matrix without an inverse needs it.
// Errors: kUsage, with the choices; kNotFound; kUnsupported for profiles made of tables, or of a curve that no power describes.
Result<Display> display_from(const std::string& text, const std::optional<std::array<double, 3>>& luminance_row);

}  // namespace latent::convert
