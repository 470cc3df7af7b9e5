#include "color/to_srgb.h"

#include "color/adaptation.h"

namespace latent::color {

Result<Matrix3> srgb_from(const Chromaticities& chromaticities, bool is_white_neutral) {
    const RgbSpace& srgb = RgbSpace::srgb();
    const Primaries primaries = primaries_of(chromaticities);
    Matrix3 srgb_from_xyz = srgb.rgb_from_xyz;
    if (is_white_neutral) {
        const Result<Matrix3> adapted = adaptation_matrix(primaries.white, srgb.primaries.white);
        if (!adapted) return adapted.error();
        srgb_from_xyz = srgb_from_xyz * *adapted;
    }
    if (are_xyz(primaries)) return srgb_from_xyz;
    const Result<RgbSpace> space = RgbSpace::from_primaries("of the picture", primaries, srgb.transfer);
    if (!space) return space.error();
    return srgb_from_xyz * space->xyz_from_rgb;
}

}  // namespace latent::color
