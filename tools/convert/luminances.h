// tools/convert/luminances.h: how bright the picture is, and where the print has neither drawing in its lights nor in its shadows.
#pragma once

#include "color/auto_exposure.h"
#include "color/luminance_row.h"
#include "color/print.h"

namespace latent::convert {

// Of greys.
color::PrintableRange printable_range(const color::Transfer& transfer, color::Tone tone, double sigma);

// Sums do not depend on the order of pixels.
struct Luminances {
    color::LuminanceHistogram histogram;  // positive and finite
    color::LuminanceCounts counts;

    Luminances& operator+=(const Luminances& other);
};

}  // namespace latent::convert
