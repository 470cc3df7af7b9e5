// color/rgb_space.h: display spaces: primaries, white, matrices both ways, transfer. Equations: docs/color.md, "RGB spaces".
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "color/transfer.h"
#include "color/tristimulus.h"

namespace latent::color {

struct Primaries {
    Chromaticity red, green, blue, white;
    bool operator==(const Primaries&) const = default;
};

// The axes of XYZ: how EXR files say that R, G, B hold X, Y, Z. `are_xyz`: to within 1e-4.
inline constexpr Primaries kXyzPrimaries{{1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}};
bool are_xyz(const Primaries& primaries);

// As EXR's attribute `chromaticities` has them: x and y of red, green, blue, white.
using Chromaticities = std::array<float, 8>;
Chromaticities chromaticities_of(const Primaries& primaries);
Primaries primaries_of(const Chromaticities& chromaticities);

struct RgbSpace {
    std::string name;
    Primaries primaries;  // as given; for a bare matrix, what its columns are
    Transfer transfer;
    Matrix3 rgb_from_xyz;                   // scaled so that RGB (1,1,1) has Y = 1
    Matrix3 xyz_from_rgb;                   // its inverse; zero if there is none
    std::array<double, 3> luminance_row{};  // m: Y = m . rgb; its sum is 1

    // "srgb", "display-p3", "rec2020", "adobe-rgb", or 8 numbers "rx,ry,gx,gy,bx,by,wx,wy" (encoded like sRGB).
    // Errors: kUsage, with the choices.
    static Result<RgbSpace> parse(std::string_view text);
    static std::vector<std::string> names();
    static const RgbSpace& srgb();

    // Errors: kOutOfRange if the primaries lie on a line or a y is zero.
    static Result<RgbSpace> from_primaries(std::string name, const Primaries& primaries, const Transfer& transfer);
    // From a matrix XYZ -> RGB at any scale. A singular one (a display of one or two primaries) needs `luminance_row`, which is
    // scaled to the sum 1; pass nullptr to take it from the inverse. Errors: kOutOfRange.
    static Result<RgbSpace> from_matrix(std::string name, const Matrix3& rgb_from_xyz, const std::array<double, 3>* luminance_row,
                                        const Transfer& transfer);

    // Refuses a luminance row with a component below -1e-6, naming the primary: no print can keep luminance there. Errors:
    // kOutOfRange.
    Status check_luminance_row() const;
};

}  // namespace latent::color
