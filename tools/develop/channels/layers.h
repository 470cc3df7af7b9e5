// tools/develop/channels/layers.h: what a picture holds beside its values, and how a record's row is laid out for it.
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
    bool noisy = false;     // the picture before noise is removed
    bool variance = false;  // the square of the camera image's standard error
    bool weight = false;    // sum w c
    bool count = false;     // samples that reach the pixel
    bool halves = false;    // the same picture of either half of the samples
    bool lights = false;    // the same picture by the light of each group alone
    // AOVs, of columns that the files have (aov_columns.h).
    bool albedo = false, normal = false, depth = false, position = false, id = false;
    std::vector<std::string> columns{};  // further columns of the files, by their names
    bool samples = false;                // no layer, but records of one sample become one, of light images too

    bool aovs() const { return albedo || normal || depth || position || id || !columns.empty(); }
    bool any() const { return noisy || variance || weight || count || halves || lights || aovs(); }
    bool by_sample() const { return variance || count || samples; }  // camera records of one sample count as one
    bool operator==(const Layers&) const = default;
};

// "noisy,variance,weight,count,lights,albedo,normal,depth,position,id", in any order; any other name is that of a column. Errors:
// kUsage. Halves are an option of their own.
Result<Layers> parse_layers(std::string_view text);

// Either half of the samples, 0 or 1: the lowest bit of h(n) = mix(n / 2) + n mod 2^64, with the finaliser of [SplitMix64]. Of two
// neighbours 2i and 2i + 1, one lies in each half: so both are equally large, and can be counted without looking at each sample.
inline int half_of(std::uint64_t sample) {
    std::uint64_t z = sample / 2;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return static_cast<int>(((z ^ (z >> 31)) + sample) & 1);
}
std::uint64_t count_in_half(const sampledb::Coverage& coverage, int half);

// Sums of a pixel, and values of a record's row, `stride` of each: so many entries (multiples of 4) are weighted by the filter w,
// then so many by w^2, then so many by 1 wherever w is not 0. The last ones, four or none, are not added up:
// `choose` keeps those of one record.
struct EntryCounts {
    int linear, squared = 0, counted = 0, chosen = 0;
    // Implicit: most pictures have linear entries alone.
    EntryCounts(int of_w, int of_w_squared = 0, int of_one = 0, int kept = 0)
        : linear(of_w), squared(of_w_squared), counted(of_one), chosen(kept) {}
    int added() const { return linear + squared + counted; }
    int stride() const { return added() + chosen; }
};

// Chooses between two things that a pixel could be, each a key and two numbers: the larger key wins, among equal keys the smaller
// numbers. So it does not matter which comes first. Keys that are not positive are nothing.
inline void choose(double key, double first, double second, double* kept) {
    if (!(key > 0) || key < kept[0]) return;
    if (key == kept[0] && (first > kept[1] || (first == kept[1] && second >= kept[2]))) return;
    kept[0] = key, kept[1] = first, kept[2] = second;
}

// Adds sums of pixels to others.
inline void add_sums(const EntryCounts& entries, const double* from, double* to, std::int64_t doubles) {
    if (entries.chosen == 0) {
        for (std::int64_t i = 0; i < doubles; ++i) to[i] += from[i];
        return;
    }
    const int stride = entries.stride(), added = entries.added();
    for (std::int64_t at = 0; at < doubles; at += stride, from += stride, to += stride) {
        for (int i = 0; i < added; ++i) to[i] += from[i];
        choose(from[added], from[added + 1], from[added + 2], to + added);
    }
}

// Where things stand in a row of `channels` values s with their share c, which divides them; with the ratio estimator, each has a
// divisor d of its own:
//   s.. c [d..] 0..  [the same for half 0]  [s.. 0.. [the same for half 0] for each group of lights]  [AOVs, times c]  [s^2.. s c..
//   c^2 0..] or [s^2.. s d.. d^2.. 0..]  [1 0 0 0] [1 object material 0]
struct RowLayout {
    int channels = 3;
    Layers layers;
    bool ratio = false;
    std::vector<std::string> lights{};  // names of the groups, if they are layers

    int divisors() const { return ratio ? channels : 1; }
    int share() const { return channels; }
    int divisor(int channel) const { return ratio ? channels + 1 + channel : channels; }
    int filled() const { return channels + 1 + (ratio ? channels : 0); }
    int linear() const { return (filled() + 3) / 4 * 4; }
    int half() const { return linear(); }  // where half 0 begins
    int light(std::size_t group) const { return linear() * (layers.halves ? 2 : 1) + static_cast<int>(group) * light_entries(); }
    int light_half(std::size_t group) const { return light(group) + light_values(); }
    int light_values() const { return (channels + 3) / 4 * 4; }  // a record adds to those of one group, in whole vectors
    int light_entries() const { return light_values() * (layers.halves ? 2 : 1); }
    int albedo() const { return light(lights.size()); }  // x, y, z
    int normal() const { return albedo() + (layers.albedo ? 3 : 0); }
    int depth() const { return normal() + (layers.normal ? 3 : 0); }   // and 1 where there is any
    int position() const { return depth() + (layers.depth ? 2 : 0); }  // and 1 where there is any
    int column(std::size_t i) const { return position() + (layers.position ? 4 : 0) + 2 * static_cast<int>(i); }  // and 1
    int squares() const { return (column(layers.columns.size()) + 3) / 4 * 4; }                                   // s^2
    int products() const { return squares() + channels; }                                                         // s c
    int divisor_square(int channel) const { return squares() + 2 * channels + (ratio ? channel : 0); }            // c^2
    int counter() const { return squares() + (layers.variance ? (2 * channels + divisors() + 3) / 4 * 4 : 0); }
    int chosen() const { return counter() + (layers.count ? 4 : 0); }
    EntryCounts entries() const { return {squares(), counter() - squares(), layers.count ? 4 : 0, layers.id ? 4 : 0}; }
    int stride() const { return entries().stride(); }

    // The sum that is closest to 0 of those that divide, all of which have the same expectation.
    double min_divisor(const double* sums) const {
        double least = sums[share()];
        for (int c = 0; c < channels && ratio; ++c) least = sums[divisor(c)] < least ? sums[divisor(c)] : least;
        return least;
    }

    // Values of a finished pixel: channels, [the same], [variances], [weight], [count], [half 0], [half 1],
    // [group of lights, [half 0], [half 1]].., [AOVs].
    int outputs() const {
        const int with_halves = layers.halves ? 3 : 1;
        return channels *
                   ((layers.noisy ? 1 : 0) + (layers.variance ? 1 : 0) + with_halves * (1 + static_cast<int>(lights.size()))) +
               (layers.weight ? 1 : 0) + (layers.count ? 1 : 0) + (layers.albedo ? 3 : 0) + (layers.normal ? 3 : 0) +
               (layers.depth ? 1 : 0) + (layers.position ? 3 : 0) + (layers.id ? 2 : 0) + static_cast<int>(layers.columns.size());
    }
    // Their names in an EXR: those of the channels, "noisy.R", "variance.R", "weight", "count", "half0.R", "half1.R",
    // "light.lamp.R", "half0.light.lamp.R", "half1.light.lamp.R", "albedo.R", "N.X", "Z", "P.X", "id.object", "id.material", then
    // columns by their names, "extra.NAME" where the name is taken.
    std::vector<std::string> names(const std::vector<std::string>& channel_names) const;
};

}  // namespace latent::develop
