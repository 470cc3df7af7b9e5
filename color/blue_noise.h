// color/blue_noise.h: thresholds without low frequencies, for dither that is hard to see. Equations: docs/color.md, "Code values".
#pragma once

#include <array>

namespace latent::color {

inline constexpr int kBlueNoiseSize = 64;

// (k + 1/2) / 4096, each k of 0..4095 once, ordered by void and cluster [Ulichney93] on a torus. Rows are written twice, so that
// any 64 neighbours can be read from each of the first 64 places. Made when first asked for, by sums of integers, so that their
// order does not matter.
using BlueNoiseRow = std::array<float, 2 * kBlueNoiseSize>;
const std::array<BlueNoiseRow, kBlueNoiseSize>& blue_noise();

}  // namespace latent::color
