// tools/convert/field_of_view.h: the angle that a picture covers, for what depends on angles.
#pragma once

namespace latent::convert {

// Degrees that the longer side of a picture covers.
struct FieldOfView {
    static constexpr double kMin = 0.1, kMax = 150;
    double degrees = 40;
    bool is_possible() const { return degrees >= kMin && degrees <= kMax; }
};

}  // namespace latent::convert
