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
    void add(std::span<const float> y);
    LuminanceHistogram& operator+=(const LuminanceHistogram& other);

    std::uint64_t count() const;  // how many values are positive and finite
    std::uint64_t dark() const;   // how many are finite, and zero or negative
    // exp of the mean log luminance of the pixels between two percentiles of the positive ones, and not below `least`.
    double log_average(double p_low, double p_high, double least = 0) const;
    // The luminance that a share `p` of the positive values does not exceed, to 0.8 %; 0 if there are none.
    double lit_percentile(double p) const;
    // The luminance that a share `p` of the finite values does not exceed, to 0.8 %; 0 among the dark ones, and of an empty
    // histogram.
    double percentile(double p) const;

 private:
    static constexpr std::size_t kLanes = 4;
    std::uint64_t bin(std::size_t index) const;
    // The luminance of this rank among all values, of which the first `below` are not positive.
    double luminance_of_rank(double rank, std::uint64_t below) const;
    void settle();

    // A count in memory has to be written before it is read again, and neighbouring pixels share a bin: so each of four has counts
    // of its own, bin by bin, by sign, exponent and first 6 bits of mantissa.
    std::vector<std::uint32_t> recent_;  // empty until something is added
    std::uint64_t recent_count_ = 0;
    std::vector<std::uint64_t> settled_;  // empty until something is settled
    std::uint64_t zeros_ = 0;
};

// The sigma that gives the log average of all but the darkest and brightest 1 % this exposure (by default, that which the film
// prints at y' = 0.18), rounded to 4 digits, so that the number printed is the number used. What is eight stops darker
// than the brightest tenth of the lit pixels prints nearly black beside them, and does not count: noise there, or the rims of small
// lights, would decide.
// Errors: kOutOfRange if no pixel has a positive luminance.
Result<double> auto_sigma(const LuminanceHistogram& histogram, double exposure = 0.28630418515664108);

}  // namespace latent::color
