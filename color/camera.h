// color/camera.h: a camera's three responses as the nearest thing to an eye. Equations: docs/color.md, "Cameras".
#pragma once

#include <vector>

#include "base/result.h"
#include "color/observer.h"
#include "color/spectrum.h"
#include "color/tristimulus.h"

namespace latent::color {

// Reflectances of the 24 patches of a ColorChecker Classic, left to right and top to bottom.
const std::vector<Spectrum>& color_checker();

struct CameraFit {
    // XYZ of CIE 1931 from a camera's balanced r, g, b (those of D65 are 1): least squares over the 24 patches under D65, where
    // (1, 1, 1) becomes D65 exactly (white-point preserving least squares, [FinlaysonDrew97]).
    Matrix3 xyz_from_rgb;
    double mean_difference, largest_difference;  // CIEDE2000 of the patches
};
// Errors: kOutOfRange if the three responses do not differ.
Result<CameraFit> fit_camera(const Observer& camera);

}  // namespace latent::color
