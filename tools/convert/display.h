// tools/convert/display.h: the display that a print is made for: its RGB space and how files say so.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/bytes.h"
#include "base/result.h"
#include "color/rgb_space.h"
#include "tools/convert/device.h"

namespace latent::convert {

struct Display {
    color::RgbSpace space;
    color::Chromaticity white;  // what the picture's white is adapted to
    Bytes icc;                  // a profile that says the same; carries no date
    bool srgb = false;
    bool grey = false;                                // it has one channel
    std::optional<std::array<std::uint8_t, 4>> cicp;  // code points of ITU-T H.273 that say the same, if there are any
    std::shared_ptr<const DeviceTransform> device;    // from linear light to codes, where no Transfer describes that

    // For a proof: the space that is printed to first, and what turns that print into light of this display.
    std::optional<color::RgbSpace> proof_space;
    std::shared_ptr<const DeviceTransform> proof;
    std::string proof_name;                    // what the simulated profile calls itself
    std::shared_ptr<const DeviceGamut> gamut;  // the gamut of a profile with tables, or of the one that is simulated

    bool has_tables() const { return device && gamut; }
    const color::RgbSpace& print_space() const { return proof_space ? *proof_space : space; }
    color::Chromaticity print_white() const { return proof_space ? proof_space->primaries.white : white; }
};

// `text`: a name ("srgb", "display-p3", "rec2020", "adobe-rgb"), 8 numbers "rx,ry,gx,gy,bx,by,wx,wy", 9 numbers,
// the matrix from XYZ to linear RGB row by row (both encoded like sRGB), or an ICC profile *.icc or *.icm of RGB: of three
// primaries and their curves, or of tables. `luminance_row` replaces the luminances m of the primaries; a matrix without an inverse
// needs it. Errors: kUsage, with the choices; kNotFound; kForeign, kUnsupported.
Result<Display> display_from(const std::string& text, const std::optional<std::array<double, 3>>& luminance_row,
                             const Rendering& rendering = {});
// Makes prints for `display` look as they will on the device of another profile. Errors as of proof_of.
Status add_proof(const std::string& path, const Rendering& rendering, Display& display);

}  // namespace latent::convert
