// tools/convert/luminances.h: how bright the picture is, and where the print has neither drawing in its lights nor in its shadows.
#pragma once

#include "color/print.h"

namespace latent::convert {

// The range of greys that can be printed.
color::PrintableRange printable_range(const color::Transfer& transfer, color::Tone tone, const color::ToneCurve& curve,
                                      double sigma);

}  // namespace latent::convert
