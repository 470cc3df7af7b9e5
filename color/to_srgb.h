// color/to_srgb.h: linear sRGB from the linear RGB of a picture file.
#pragma once

#include "color/rgb_space.h"

namespace latent::color {

// For primaries that are the axes of XYZ: from XYZ. `is_white_neutral`: their white becomes that of sRGB, by adaptation.h. Errors:
// kOutOfRange: primaries that span no space.
Result<Matrix3> srgb_from(const Chromaticities& chromaticities, bool is_white_neutral = false);

}  // namespace latent::color
