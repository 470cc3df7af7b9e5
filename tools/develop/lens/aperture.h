// tools/develop/lens/aperture.h: the opening of a lens, as --aperture describes it. docs/developing.md, "Aperture".
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "image/blades.h"

namespace latent::develop {

// On the unit disk of the lens that was rendered; x to the right and y upwards, as the camera sees them.
struct Aperture {
    double radius = 1;    // that of the circle through the corners between blades; 0 < radius <= 1
    double f_number = 0;  // or, until it is known which was rendered: recorded_lens.h
    image::Blades blades{};
    double squeeze = 1;     // the width is divided by this, at least 1
    double cat_eye = 0;     // in the corners of the picture: distance between the rims of the lens, in rendered radii
    bool gaussian = false;  // transmits e^(-2 r^2 / radius^2)
    enum class Half : std::uint8_t { kBoth, kLeft, kRight } half = Half::kBoth;

    bool is_whole() const { return *this == Aperture{}; }
    bool operator==(const Aperture&) const = default;
};

// "0.35", "f:8", "blades:6:15:0.2", "gaussian", "anamorphic:1.33", "cat-eye:0.5", "left", "right", or several with commas between
// them. Errors: kUsage.
Result<Aperture> parse_aperture(std::string_view text);

// The square of 2 x 2 around the unit disk is cut into kLensCells x kLensCells cells, rows upwards in y: what the lens columns of
// records tell apart (docs/format.md, "Registry").
inline constexpr std::size_t kLensCells = 256;

// What is known of each cell.
struct LensCells {
    std::vector<float> area;          // the share of it that lies in the unit disk
    std::vector<float> transmission;  // its mean there, 0..1; without `cat_eye`, which differs over the film
};
LensCells cells_of(const Aperture& aperture);

}  // namespace latent::develop
