// color/spectral_bins.h: observers of spectra that are known as means over bins. Equations: docs/color.md, "Spectral pictures".
#pragma once

#include <array>
#include <span>
#include <vector>

#include "color/observer.h"

namespace latent::color {

// For bins whose centres [nm] strictly increase, at least two: the integrals of the observer's three curves over each of them,
// within 360..830 nm, so that a pixel is the sum of means times integrals. Bins meet half-way between their centres; the outermost
// are symmetric.
std::vector<std::array<double, 3>> bin_integrals(const Observer& observer, std::span<const double> centres_nm);

}  // namespace latent::color
