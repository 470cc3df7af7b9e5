// color/adaptation.h: what is white here becomes what is white there. Equations: docs/color.md, "Adaptation".
#pragma once

#include "base/result.h"
#include "color/tristimulus.h"

namespace latent::color {

enum class Adaptation {
    kBradford,  // linear Bradford, as in ICC profiles [ICC]
    kCat16,     // the cone matrix of CIECAM16 [CAT16]
    kNone,
};

// Von Kries in the space of B: XYZ' = B^-1 diag(B W_to / B W_from) B XYZ with whites of Y = 1, so white goes to white and keeps its
// Y. The identity if the whites are equal or `how` is kNone. Errors: kOutOfRange if a white is not inside the xy triangle, or has a
// cone response that is not positive.
Result<Matrix3> adaptation_matrix(Chromaticity from, Chromaticity to, Adaptation how);

}  // namespace latent::color
