// color/adaptation.h: what is white here becomes what is white there. Equations: docs/color.md, "Adaptation".
#pragma once

#include "base/result.h"
#include "color/tristimulus.h"

namespace latent::color {

// Von Kries in the space of B, the linear Bradford cones of ICC profiles [ICC]: XYZ' = B^-1 diag(B W_to / B W_from) B XYZ with
// whites of Y = 1, so white goes to white and keeps its Y. The identity if the whites are equal. Errors: kOutOfRange if a white is
// not inside the xy triangle, or has a cone response that is not positive.
Result<Matrix3> adaptation_matrix(Chromaticity from, Chromaticity to);

}  // namespace latent::color
