#include "tools/convert/luminances.h"

#include <cmath>

namespace latent::convert {

// The curve's inverse at half a step from its ends.
color::PrintableRange printable_range(const color::Transfer& transfer, color::Tone tone, const color::ToneCurve& curve,
                                      double sigma) {
    const auto luminance = [&](double code) {
        const double printed = transfer.decode(code / 255);
        const double exposure = tone == color::Tone::kFilm    ? -std::log2(1 - printed)
                                : tone == color::Tone::kCurve ? curve.exposure_of(printed)
                                                              : printed;
        return static_cast<float>(exposure / sigma);
    };
    return {luminance(0.5), luminance(254.5)};
}

}  // namespace latent::convert
