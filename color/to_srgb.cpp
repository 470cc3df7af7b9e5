#include "color/to_srgb.h"

namespace latent::color {

Result<Matrix3> srgb_from(const Chromaticities& chromaticities) {
    const RgbSpace& srgb = RgbSpace::srgb();
    const Primaries primaries = primaries_of(chromaticities);
    if (are_xyz(primaries)) return srgb.rgb_from_xyz;
    const Result<RgbSpace> space = RgbSpace::from_primaries("file", primaries, srgb.transfer);
    if (!space) return space.error();
    return srgb.rgb_from_xyz * space->xyz_from_rgb;
}

}  // namespace latent::color
