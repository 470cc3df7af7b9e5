// color/auto_exposure.h: a sensitivity chosen from the picture's luminances. Equations: docs/color.md, "Auto exposure".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace latent::color {

// Counts of luminances in bins of 1/64 octave over all positive floats. Sums of histograms do not depend on their order.
class LuminanceHistogram {
 public:
    LuminanceHistogram();
    void add(std::span<const float> y);  // only positive finite values count
    LuminanceHistogram& operator+=(const LuminanceHistogram& other);

    std::uint64_t count() const;
    // exp of the mean log luminance of the pixels between two percentiles.
    double log_average(double p_low, double p_high) const;
    // The luminance that a share `p` of the pixels does not exceed, to 0.8 %, where `dark` pixels more have none: 0 among these,
    // and of an empty histogram.
    double percentile(double p, std::uint64_t dark) const;

 private:
    std::vector<std::uint64_t> bins_;
};

// The sigma that gives the log average of all but the darkest and brightest 1 % this exposure (by default, that which the film
// prints at y' = 0.18), rounded to 4 digits, so that the number printed is the number used. Errors: kOutOfRange if no pixel has a
// positive luminance.
Result<double> auto_sigma(const LuminanceHistogram& histogram, double exposure = 0.28630418515664108);

}  // namespace latent::color
