// tools/convert/vignette.h: the natural fall-off of light towards the corners of a picture. docs/converting.md, "Vignette".
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "base/result.h"
#include "image/rect.h"
#include "tools/convert/field_of_view.h"

namespace latent::convert {

struct Vignette {
    std::string text;  // as it was asked for
    FieldOfView field{};
};
// "cos4", "cos4:54". Errors: kUsage.
Result<Vignette> parse_vignette(std::string_view text);

// The light of pixels x0, x0 + 1, ... of row y, times cos^4 of the angle between the axis of the camera, at the centre of `whole`,
// and the ray through a pixel's centre.
class FallOff {
 public:
    FallOff(const Vignette& vignette, const image::Rect& whole);
    void apply(int x0, int y, std::span<float> row) const;

 private:
    double centre_x_, centre_y_, per_pixel_;  // tangent of the angle
};

}  // namespace latent::convert
