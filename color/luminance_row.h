// color/luminance_row.h: luminances of pixels and which of them can be printed, one source for every vector width.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace latent::color {

// Luminances whose grey has code 0 and 255 of 8 bits: below `black`, from `burnt` on.
struct PrintableRange {
    float black = 0, burnt = 0;
};

struct LuminanceCounts {
    std::uint64_t dark = 0;              // zero, or negative
    std::uint64_t black = 0, burnt = 0;  // below and above the printable range

    LuminanceCounts& operator+=(const LuminanceCounts& other);
};

// out = y_row . (x, y, z), summed in double, or y where x, y or z is not finite, as the print has it. All of the same size.
LuminanceCounts luminance_row(const std::array<double, 3>& y_row, const PrintableRange& range, std::span<const float> x,
                              std::span<const float> y, std::span<const float> z, std::span<float> out);

}  // namespace latent::color
