// tools/convert/luminances.h: how bright the picture is, and where the print has neither drawing in its lights nor in its shadows.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "color/auto_exposure.h"
#include "color/print.h"

namespace latent::convert {

// y = y_row . (x, y, z), or y where x or z is not finite, as the print has it.
void adapted_luminances(const std::array<double, 3>& y_row, std::span<const float> x, std::span<const float> y,
                        std::span<const float> z, std::span<float> out);

// Luminances whose grey has code 0 and 255 of 8 bits: below `black`, from `burnt` on.
struct PrintableRange {
    float black = 0, burnt = 0;
};
PrintableRange printable_range(const color::Transfer& transfer, color::Tone tone, double sigma);

// Counts of pixels by their luminance after adaptation; sums do not depend on their order.
struct Luminances {
    color::LuminanceHistogram histogram;  // positive and finite
    std::uint64_t dark = 0;               // zero, or negative
    std::uint64_t black = 0, burnt = 0;   // below and above the printable range

    void add(std::span<const float> y, const PrintableRange& range);
    Luminances& operator+=(const Luminances& other);
};

}  // namespace latent::convert
