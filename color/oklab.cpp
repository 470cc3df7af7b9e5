#include "color/oklab.h"

#include <cmath>
#include <numbers>

namespace latent::color {

double Oklab::chroma() const { return std::hypot(a, b); }
double Oklab::hue_degrees() const { return std::atan2(b, a) * 180 / std::numbers::pi; }

Oklab oklab_from_xyz(Xyz c) {
    const double l = std::cbrt(0.8189330101 * c.x + 0.3618667424 * c.y - 0.1288597137 * c.z);
    const double m = std::cbrt(0.0329845436 * c.x + 0.9293118715 * c.y + 0.0361456387 * c.z);
    const double s = std::cbrt(0.0482003018 * c.x + 0.2643662691 * c.y + 0.6338517070 * c.z);
    return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s, 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
            0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

}  // namespace latent::color
