#include "image/blades.h"

#include <algorithm>
#include <cmath>

#include "base/angle.h"
#include "base/parse.h"

namespace latent::image {

Result<Blades> parse_blades(const NamedNumbers& named, std::string_view text) {
    const std::vector<double>& n = named.numbers;
    if (n.empty() || n.size() > 3 || !(n[0] >= 3 && n[0] <= 64) || n[0] != std::floor(n[0]))
        return is_not(text,
                      "blades:COUNT, blades:COUNT:ROTATION or blades:COUNT:ROTATION:CURVATURE, with 3 to 64 blades (try blades:6)");
    Blades blades{static_cast<int>(n[0]), n.size() > 1 ? n[1] : 0, n.size() > 2 ? n[2] : 0};
    if (!(std::abs(blades.rotation_degrees) <= 360)) return is_not(text, "a rotation of -360 to 360 degrees");
    if (!(blades.curvature >= 0 && blades.curvature <= 1)) return is_not(text, "a curvature from 0 (straight) to 1 (a circle)");
    return blades;
}

BladeOpening::BladeOpening(const Blades& blades, double radius) : radius_(radius), curvature_(blades.curvature) {
    for (int i = 0; i < blades.count && curvature_ < 1; ++i)
        normals_.push_back(cos_sin_of_degrees(blades.rotation_degrees + (i + 0.5) * 360 / blades.count));
    if (blades.count > 0) apothem_ = radius * cos_sin_of_degrees(180.0 / blades.count)[0];
}

double BladeOpening::inside(double x, double y) const {
    if (normals_.empty()) return radius_ - std::sqrt(x * x + y * y);
    double along = 0;
    for (const std::array<double, 2>& n : normals_) along = std::max(along, n[0] * x + n[1] * y);
    if (curvature_ == 0) return apothem_ - along;
    // 1 on the edge, and proportional to the distance from the centre.
    const double size = (1 - curvature_) * along / apothem_ + curvature_ * std::sqrt(x * x + y * y) / radius_;
    return (1 - size) / ((1 - curvature_) / apothem_ + curvature_ / radius_);
}

}  // namespace latent::image
