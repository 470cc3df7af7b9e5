// tools/convert/camera_exposure.h: how bright a print is, as cameras are set. docs/color.md, "As cameras are set".
#pragma once

#include <string_view>

#include "base/result.h"

namespace latent::convert {

struct CameraExposure {
    double iso = 0, seconds = 0, f_number = 0;

    // The luminance in cd/m^2 that saturates the sensor [ISO12232]: 78 / S lux seconds, of which L gives 0.65 L t / N^2.
    double saturation() const;
    // Sensitivity of the print, which has display white there if the tone is linear; Y = 1 is `unit` cd/m^2.
    double sensitivity(double unit) const { return 2 * unit / saturation(); }
};
// "iso:100,time:1/125,f:8", in any order; the time in seconds. Errors: kUsage.
Result<CameraExposure> parse_camera_exposure(std::string_view text);

}  // namespace latent::convert
