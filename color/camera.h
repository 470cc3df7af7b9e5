// color/camera.h: a camera's three responses as the nearest thing to an eye. Equations: docs/color.md, "Cameras".
#pragma once

#include <array>
#include <vector>

#include "base/result.h"
#include "color/spectrum.h"
#include "color/tristimulus.h"

namespace latent::color {

// The matrix M that makes XYZ of a camera's r, g, b: it minimises the expected squared error of XYZ under D65 over random
// reflectances whose correlation falls by 1/e in 80 nm, and leaves D65 exact (white-point preserving least squares,
// [FinlaysonDrew97] with the prior of [PrattMancill76]). Errors: kOutOfRange if the three responses do not differ.
Result<Matrix3> xyz_from_camera(const std::array<Spectrum, 3>& responses);

}  // namespace latent::color
