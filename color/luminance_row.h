// color/luminance_row.h: luminances of pixels that are not printed yet, one source for every vector width.
#pragma once

#include <array>
#include <span>

namespace latent::color {

// out = y_row . (x, y, z), summed in double, or y where x, y or z is not finite, as the print has it. All of the same size.
void luminance_row(const std::array<double, 3>& y_row, std::span<const float> x, std::span<const float> y, std::span<const float> z,
                   std::span<float> out);

}  // namespace latent::color
