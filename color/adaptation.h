// color/adaptation.h: chromatic adaptation, from one white to another. Equations: docs/color.md, "Adaptation".
#pragma once

#include <string_view>

#include "base/result.h"
#include "color/tristimulus.h"

namespace latent::color {

// Whose responses are scaled.
enum class Cones {
    kBradford,  // as in ICC profiles, without their exponent for blue [ICC]
    kCat16,     // as in CAM16, fully adapted [Li17]
};
Result<Cones> cones_by_name(std::string_view name);  // "bradford", "cat16"

// Von Kries in the space of the cones B: XYZ' = B^-1 diag(B W_to / B W_from) B XYZ with whites of Y = 1, so white goes to white and
// keeps its Y. The identity if the whites are equal. Errors: kOutOfRange if a white is not inside the xy triangle, or has a cone
// response that is not positive.
Result<Matrix3> adaptation_matrix(Chromaticity from, Chromaticity to, Cones cones = Cones::kBradford);

}  // namespace latent::color
