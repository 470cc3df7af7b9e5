// tools/develop/layers.h: what a picture holds beside its values, and how a record's row is laid out for it.
// docs/developing.md, "Layers".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "sampledb/data/coverage.h"

namespace latent::develop {

struct Layers {
    bool variance = false;  // of the camera image: the square of its standard error
    bool weight = false;    // sum w c
    bool count = false;     // samples that reach the pixel
    bool halves = false;    // the same picture of either half of the samples
    bool samples = false;   // no layer, but records of one sample become one, of light images too

    bool any() const { return variance || weight || count || halves; }
    bool by_sample() const { return variance || count || samples; }  // camera records of one sample count as one
    bool operator==(const Layers&) const = default;
};

// "variance,weight,count", in any order. Errors: kUsage. Halves are an option of their own.
Result<Layers> parse_layers(std::string_view text);

// Either half of the samples, 0 or 1: the lowest bit of h(n) = mix(n / 2) + n mod 2^64, with the finaliser of [SplitMix64]. Of two
// neighbours 2i and 2i + 1, one lies in each half: so both are equally large, and can be counted without looking at each sample.
int half_of(std::uint64_t sample);
std::uint64_t count_in_half(const sampledb::Coverage& coverage, int half);

// Sums of a pixel, and values of a record's row, `stride` of each: so many lanes (multiples of 4) are weighted by the filter w,
// then so many by w^2, then so many by 1 wherever w is not 0.
struct Lanes {
    int linear, squared = 0, counted = 0;
    Lanes(int linear_lanes, int squared_lanes = 0, int counted_lanes = 0)  // implicit: most pictures have linear ones alone
        : linear(linear_lanes), squared(squared_lanes), counted(counted_lanes) {}
    int stride() const { return linear + squared + counted; }
};

// Where things stand in a row of `channels` values s with their share c, which divides them; with the ratio estimator, each has a
// divisor d of its own:
//   s.. c [d..] 0..  [the same for half 0]  [s^2.. s c.. c^2 0..] or [s^2.. s d.. d^2.. 0..]  [1 0 0 0]
struct RowLayout {
    int channels = 3;
    Layers layers;
    bool ratio = false;

    int divisors() const { return ratio ? channels : 1; }
    int share() const { return channels; }
    int divisor(int channel) const { return ratio ? channels + 1 + channel : channels; }
    int filled() const { return channels + 1 + (ratio ? channels : 0); }
    int linear() const { return (filled() + 3) / 4 * 4; }
    int half() const { return linear(); }                                                               // where half 0 begins
    int squares() const { return linear() * (layers.halves ? 2 : 1); }                                  // s^2
    int products() const { return squares() + channels; }                                               // s c
    int divisor_square(int channel) const { return squares() + 2 * channels + (ratio ? channel : 0); }  // c^2
    int counter() const { return squares() + (layers.variance ? (2 * channels + divisors() + 3) / 4 * 4 : 0); }
    Lanes lanes() const { return {squares(), counter() - squares(), layers.count ? 4 : 0}; }
    int stride() const { return lanes().stride(); }

    // The sum that is closest to 0 of those that divide, all of which have the same expectation.
    double least_divisor(const double* sums) const {
        double least = sums[share()];
        for (int c = 0; c < channels && ratio; ++c) least = sums[divisor(c)] < least ? sums[divisor(c)] : least;
        return least;
    }

    // Values of a finished pixel: channels, [variances], [weight], [count], [half 0], [half 1].
    int outputs() const {
        return channels * (1 + (layers.variance ? 1 : 0) + (layers.halves ? 2 : 0)) + (layers.weight ? 1 : 0) +
               (layers.count ? 1 : 0);
    }
    // Their names in an EXR: those of the channels, "variance.R", "weight", "count", "half0.R", "half1.R".
    std::vector<std::string> names(const std::vector<std::string>& channel_names) const;
};

}  // namespace latent::develop
