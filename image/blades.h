// image/blades.h: the opening of a lens between its blades. docs/developing.md, "Aperture".
#pragma once

#include <array>
#include <vector>

#include "base/option_parts.h"
#include "base/result.h"

namespace latent::image {

// x to the right and y upwards, as the camera sees them.
struct Blades {
    int count = 0;                // 0: a round opening; else 3 to 64
    double rotation_degrees = 0;  // angle of the first corner, from the x axis towards the y axis
    double curvature = 0;         // 0 straight, 1 the circle through the corners

    bool operator==(const Blades&) const = default;
};

// "blades:6", "blades:6:15", "blades:6:15:0.2": a count, a rotation and a curvature. Errors: kUsage, naming `text`.
Result<Blades> parse_blades(const NamedNumbers& named, std::string_view text);

class BladeOpening {
 public:
    // `radius`: of the circle, on which the corners lie. The same bits on every processor.
    BladeOpening(const Blades& blades, double radius);

    // Distance to the edge, positive within the opening: exact along straight blades and circles, else to first order.
    double inside(double x, double y) const;

 private:
    double radius_, curvature_;
    double apothem_ = 0;                          // distance of straight blades from the centre
    std::vector<std::array<double, 2>> normals_;  // normals of their edges; none: a circle
};

}  // namespace latent::image
