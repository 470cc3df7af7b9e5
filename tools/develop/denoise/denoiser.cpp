#include "tools/develop/denoise/denoiser.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <utility>

#include "tools/develop/denoise/row_loops.h"

namespace latent::develop {

namespace {

constexpr std::int64_t kRadius = 5;          // within which neighbours are looked for
constexpr std::int64_t kPatch = 1;           // of what is compared around a pixel and its neighbour
constexpr std::int64_t kVarianceRadius = 2;  // within which a variance is measured
static_assert(kDenoiseReach == kRadius + kPatch + kVarianceRadius);

constexpr std::int64_t kStrip = 32;  // rows that are denoised at once: what they take stays in the nearest caches

constexpr float kNormal = 0.2f, kDepth = 0.04f, kAlbedo = 0.1f;  // differences of surfaces: of depth, relative and per pixel
constexpr float kSquares = 6;                                    // weights end at this many of these

// Variance over squared value, at most, when pixels are compared. The light of one sample, or of few, cannot show how much it
// varies: such a pixel would be like all others. Their light would go over to the dark.
constexpr float kCertain = 0.25f;

// Numbers of a rectangle of pixels; any, at first.
class Plane {
 public:
    explicit Plane(const PixelRect& pixels)
        : pixels_(pixels),
          values_(std::make_unique_for_overwrite<float[]>(static_cast<std::size_t>(pixels.width() * pixels.height()))) {}
    // So that row(y)[x] is that of pixel (x, y).
    float* row(std::int64_t y) { return values_.get() + (y - pixels_.y0) * pixels_.width() - pixels_.x0; }
    const float* row(std::int64_t y) const { return values_.get() + (y - pixels_.y0) * pixels_.width() - pixels_.x0; }
    const PixelRect& pixels() const { return pixels_; }

 private:
    PixelRect pixels_;
    std::unique_ptr<float[]> values_;
};

PixelRect grown(const PixelRect& r, std::int64_t by) { return {r.x0 - by, r.y0 - by, r.x1 + by, r.y1 + by}; }
PixelRect moved(const PixelRect& r, std::int64_t x, std::int64_t y) { return {r.x0 + x, r.y0 + y, r.x1 + x, r.y1 + y}; }

// For each of `pixels`, what `make` makes of the numbers that `from` has there.
template <class Make, class... From>
Plane made(const PixelRect& pixels, const Make& make, const From&... from) {
    Plane plane(pixels);
    for (std::int64_t y = pixels.y0; y < pixels.y1; ++y) {
        float* const to = plane.row(y);
        const auto fill = [&](auto... rows) {
            for (std::int64_t x = pixels.x0; x < pixels.x1; ++x) to[x] = make(rows[x]...);
        };
        fill(from.row(y)...);
    }
    return plane;
}
float finite(float x) { return std::isfinite(x) ? x : 0.0f; }

// How many of the places at most `radius` from each of first .. end-1 lie in `in_first` .. `in_end`-1.
std::vector<float> counts_around(std::int64_t first, std::int64_t end, std::int64_t radius, std::int64_t in_first,
                                 std::int64_t in_end) {
    std::vector<float> counts;
    for (std::int64_t at = first; at < end; ++at)
        counts.push_back(static_cast<float>(std::min(at + radius + 1, in_end) - std::max(at - radius, in_first)));
    return counts;
}

// Sums over squares of 2 `radius` + 1 around `wanted`, of their pixels in `counted`. fill(y, x, n, to) writes the numbers of n
// pixels from (x, y) on. Each is added up in the same order, wherever `wanted` begins.
template <class Fill>
Plane sums_around(const PixelRect& wanted, std::int64_t radius, const PixelRect& counted, const Fill& fill) {
    const auto n = static_cast<std::size_t>(wanted.width()), side = static_cast<std::size_t>(2 * radius + 1);
    const PixelRect around = grown(wanted, radius), filled = intersection(around, counted);
    Plane numbers = filled == around ? Plane(around) : made(around, [] { return 0.0f; });
    Plane across({wanted.x0, around.y0, wanted.x1, around.y1}), sums(wanted);
    for (std::int64_t y = filled.y0; y < filled.y1; ++y)
        fill(y, filled.x0, static_cast<std::size_t>(filled.width()), numbers.row(y) + filled.x0);
    for (std::int64_t y = around.y0; y < around.y1; ++y) add_up(n, side, numbers.row(y) + around.x0, 1, across.row(y) + wanted.x0);
    for (std::int64_t y = wanted.y0; y < wanted.y1; ++y)
        add_up(n, side, across.row(y - radius) + wanted.x0, n, sums.row(y) + wanted.x0);
    return sums;
}

// The variance of the mean of two halves, which is measured around each pixel.
Plane variance_of(const Plane& half0, const Plane& half1, const PixelRect& wanted) {
    const PixelRect& held = half0.pixels();
    Plane variance = sums_around(wanted, kVarianceRadius, held, [&](std::int64_t y, std::int64_t x, std::size_t n, float* to) {
        const float *const a = half0.row(y) + x, *const b = half1.row(y) + x;
        for (std::size_t i = 0; i < n; ++i) {
            const float error = (a[i] - b[i]) * 0.5f;
            to[i] = error * error;
        }
    });
    const std::vector<float> columns = counts_around(wanted.x0, wanted.x1, kVarianceRadius, held.x0, held.x1),
                             rows = counts_around(wanted.y0, wanted.y1, kVarianceRadius, held.y0, held.y1);
    for (std::int64_t y = wanted.y0; y < wanted.y1; ++y) {
        float* const to = variance.row(y) + wanted.x0;
        for (std::size_t i = 0; i < columns.size(); ++i) to[i] /= columns[i] * rows[static_cast<std::size_t>(y - wanted.y0)];
    }
    return variance;
}

struct Channel {
    Plane value, variance;
    Plane bounded;            // the variance, for comparing
    Plane sum, variance_sum;  // over neighbours, with their weights and the squares of these
};

class Denoiser {
 public:
    // `planes`: of each value of a pixel.
    Denoiser(const DenoisedValues& values, const DenoisedValues::Part& part, const PixelRect& held,
             const std::vector<Plane>& planes, const PixelRect& wanted)
        : held_(held),
          wanted_(wanted),
          with_variance_(values.variance),
          light_(values.channels),
          weights_(made(wanted, [] { return 1.0f; })) {
        const PixelRect compared = intersection(grown(wanted, kRadius + kPatch), held_);
        for (std::size_t c = 0; c < values.channels; ++c) {
            Plane value = made(held_, finite, planes[part.value + c]);
            Plane variance = variance_of(planes[part.half0 + c], planes[part.half1 + c], compared);
            Plane bounded = made(
                compared, [](float v, float x) { return std::min(v, kCertain * x * x); }, variance, value);
            Plane sum = made(wanted, std::identity(), value);
            channels_.push_back({std::move(value), std::move(variance), std::move(bounded), std::move(sum),
                                 made(with_variance_ ? wanted : PixelRect{}, [] { return 0.0f; })});
        }
        const auto add_surfaces = [&](const std::optional<std::size_t>& first, float width) {
            if (first)
                surfaces_.push_back({{&planes[*first], &planes[*first + 1], &planes[*first + 2]}, 1 / (kSquares * width * width)});
        };
        add_surfaces(values.albedo, kAlbedo);
        add_surfaces(values.normal, kNormal);
        if (values.depth) depth_ = made(held_, finite, planes[*values.depth]);  // what is infinitely far is at 0
        if (values.weight)
            known_ = made(
                held_, [](float weight) { return weight != 0 ? 1.0f : 0.0f; }, planes[*values.weight]);
        for (std::int64_t y = wanted.y0; y < wanted.y1; y += kStrip)
            add_neighbours({wanted.x0, y, wanted.x1, std::min(y + kStrip, wanted.y1)});
    }

    // Values of `wanted`, which keep 1 - amount of their own.
    Plane value(std::size_t c, float amount) const {
        const auto mix = [amount](float sum, float weights, float own) { return amount * (sum / weights) + (1 - amount) * own; };
        return made(wanted_, mix, channels_[c].sum, weights_, channels_[c].value);
    }
    Plane variance(std::size_t c, float amount) const {
        const auto mix = [amount](float sum, float weights, float variance) {
            const float each = amount / weights, own = each + 1 - amount;
            return each * each * sum + own * own * variance;
        };
        return made(wanted_, mix, channels_[c].variance_sum, weights_, channels_[c].variance);
    }

 private:
    struct Surfaces {
        std::array<const Plane*, 3> of;
        float scale;
    };

    void add_neighbours(const PixelRect& strip);
    void add_neighbours(const PixelRect& strip, std::int64_t dx, std::int64_t dy);
    void add_weighted(const PixelRect& strip, const Plane& weights, std::int64_t dx, std::int64_t dy, std::int64_t weight_x,
                      std::int64_t weight_y);

    PixelRect held_, wanted_;
    bool with_variance_;
    std::vector<Channel> channels_;
    std::vector<ComparedLight> light_;  // a row's, in each channel
    std::vector<Surfaces> surfaces_;
    std::optional<Plane> depth_;
    std::optional<Plane> known_;  // 1 where a pixel has camera records, else 0
    Plane weights_;               // sums; a pixel's own is 1
};

void Denoiser::add_neighbours(const PixelRect& strip) {
    for (std::int64_t dy = 0; dy <= kRadius; ++dy) {
        for (std::int64_t dx = dy > 0 ? -kRadius : 1; dx <= kRadius; ++dx) {
            if (dx * dx + dy * dy <= kRadius * (kRadius + 1)) add_neighbours(strip, dx, dy);
        }
    }
}

// [Welch47]: the difference of two means over its standard error, squared; its mean over the channels and over a patch around both.
// Either pixel of a pair is a neighbour of the other with the same weight, which stands at the first: the other is (dx, dy)
// further.
void Denoiser::add_neighbours(const PixelRect& strip, std::int64_t dx, std::int64_t dy) {
    const PixelRect both = intersection(held_, moved(held_, -dx, -dy));  // where the other is in the picture, too
    const PixelRect others = moved(strip, -dx, -dy);
    const PixelRect either{std::min(strip.x0, others.x0), std::min(strip.y0, others.y0), std::max(strip.x1, others.x1),
                           std::max(strip.y1, others.y1)};
    const PixelRect pairs = intersection(either, both);
    if (pairs.empty()) return;
    const auto pair = [dx, dy](const Plane& plane, std::int64_t y, std::int64_t x) {
        return Pair{plane.row(y) + x, plane.row(y + dy) + x + dx};
    };
    const Plane light = sums_around(pairs, kPatch, both, [&](std::int64_t y, std::int64_t x, std::size_t n, float* to) {
        for (std::size_t c = 0; c < channels_.size(); ++c)
            light_[c] = {pair(channels_[c].value, y, x), pair(channels_[c].bounded, y, x)};
        compare_light(n, light_, to);
    });
    const std::vector<float> columns = counts_around(pairs.x0, pairs.x1, kPatch, both.x0, both.x1),
                             rows = counts_around(pairs.y0, pairs.y1, kPatch, both.y0, both.y1);
    std::vector<ComparedVectors> vectors(surfaces_.size());
    ComparedPixels compared{.columns = columns.data(), .vectors = vectors};
    compared.depth_scale = 1 / (kSquares * kDepth * kDepth * static_cast<float>(dx * dx + dy * dy));
    Plane weights(pairs);
    for (std::int64_t y = pairs.y0; y < pairs.y1; ++y) {
        compared.light = light.row(y) + pairs.x0;
        compared.rows = rows[static_cast<std::size_t>(y - pairs.y0)];
        for (std::size_t i = 0; i < surfaces_.size(); ++i) {
            const auto& [of, scale] = surfaces_[i];
            vectors[i] = {{pair(*of[0], y, pairs.x0), pair(*of[1], y, pairs.x0), pair(*of[2], y, pairs.x0)}, scale};
        }
        if (depth_) compared.depth = pair(*depth_, y, pairs.x0);
        if (known_) compared.known = pair(*known_, y, pairs.x0);
        weigh(static_cast<std::size_t>(pairs.width()), compared, weights.row(y) + pairs.x0);
    }
    add_weighted(strip, weights, dx, dy, 0, 0);
    add_weighted(strip, weights, -dx, -dy, -dx, -dy);
}

// The neighbours (dx, dy) further, with the weights that stand (weight_x, weight_y) further.
void Denoiser::add_weighted(const PixelRect& strip, const Plane& weights, std::int64_t dx, std::int64_t dy, std::int64_t weight_x,
                            std::int64_t weight_y) {
    const PixelRect pixels = intersection(strip, moved(weights.pixels(), -weight_x, -weight_y));
    if (pixels.empty()) return;
    const auto n = static_cast<std::size_t>(pixels.width());
    for (std::int64_t y = pixels.y0; y < pixels.y1; ++y) {
        const float* const weight = weights.row(y + weight_y) + pixels.x0 + weight_x;
        add_row(n, weight, weights_.row(y) + pixels.x0);
        for (Channel& channel : channels_) {
            add_products(n, weight, channel.value.row(y + dy) + pixels.x0 + dx, channel.sum.row(y) + pixels.x0);
            if (with_variance_)
                add_squared_products(n, weight, channel.variance.row(y + dy) + pixels.x0 + dx,
                                     channel.variance_sum.row(y) + pixels.x0);
        }
    }
}

// One for each value of a pixel.
std::vector<Plane> planes_of(const PixelRect& held, std::span<const float> pixels, std::size_t values) {
    std::vector<Plane> planes;
    for (std::size_t i = 0; i < values; ++i) planes.emplace_back(held);
    const auto width = static_cast<std::size_t>(held.width());
    const float* from = pixels.data();
    for (std::int64_t y = held.y0; y < held.y1; ++y, from += width * values) {
        for (std::size_t i = 0; i < values; ++i) {
            float* const to = planes[i].row(y) + held.x0;
            for (std::size_t x = 0; x < width; ++x) to[x] = from[x * values + i];
        }
    }
    return planes;
}

// The reverse, of those of `kept`.
std::vector<float> pixels_of(const PixelRect& wanted, const std::vector<Plane>& planes, std::span<const std::size_t> kept) {
    const auto width = static_cast<std::size_t>(wanted.width());
    std::vector<float> pixels(width * static_cast<std::size_t>(wanted.height()) * kept.size());
    float* to = pixels.data();
    for (std::int64_t y = wanted.y0; y < wanted.y1; ++y, to += width * kept.size()) {
        for (std::size_t i = 0; i < kept.size(); ++i) {
            const float* const from = planes[kept[i]].row(y) + wanted.x0;
            for (std::size_t x = 0; x < width; ++x) to[x * kept.size() + i] = from[x];
        }
    }
    return pixels;
}

}  // namespace

PixelRect within_reach(const PixelRect& pixels, const PixelRect& picture) {
    return intersection(grown(pixels, kDenoiseReach), picture);
}

DenoisedValues DenoisedValues::find(const std::vector<std::string>& names) {
    DenoisedValues values;
    values.outputs = names.size();
    values.kept.resize(names.size());
    std::iota(values.kept.begin(), values.kept.end(), std::size_t{0});
    const auto place = [&](const std::string& name) -> std::optional<std::size_t> {
        const auto at = std::ranges::find(names, name);
        if (at == names.end()) return std::nullopt;
        return static_cast<std::size_t>(at - names.begin());
    };
    const auto part_of = [&](const std::string& first) {
        const auto value = place(first), half0 = place("half0." + first), half1 = place("half1." + first);
        assert(value && half0 && half1);
        return Part{*value, *half0, *half1};
    };
    values.picture = part_of(names.front());
    values.channels = values.picture.half1 - values.picture.half0;
    for (const std::string& name : names) {
        if (name.starts_with("light.") && name.ends_with("." + names.front())) values.lights.push_back(part_of(name));
    }
    values.albedo = place("albedo.R");
    values.normal = place("N.X");
    values.depth = place("Z");
    values.weight = place("weight");
    values.variance = place("variance." + names.front());
    return values;
}

std::vector<float> denoise(const DenoisedValues& values, double amount, const PixelRect& held, std::span<const float> pixels,
                           const PixelRect& wanted) {
    const auto share = static_cast<float>(amount);
    std::vector<Plane> planes = planes_of(held, pixels, values.outputs);
    const auto add = [&](Plane& sum, const Plane& more, bool is_first) {
        sum = is_first ? made(wanted, std::identity(), more) : made(wanted, std::plus(), sum, more);
    };
    const std::vector<DenoisedValues::Part> parts = values.lights.empty() ? std::vector{values.picture} : values.lights;
    for (const DenoisedValues::Part& part : parts) {
        const Denoiser denoiser(values, part, held, planes, wanted);
        const bool is_first = part.value == parts.front().value;
        for (std::size_t c = 0; c < values.channels; ++c) {
            planes[part.value + c] = denoiser.value(c, share);
            if (!values.lights.empty()) add(planes[values.picture.value + c], planes[part.value + c], is_first);
            if (values.variance) add(planes[*values.variance + c], denoiser.variance(c, share), is_first);
        }
    }
    return pixels_of(wanted, planes, values.kept);
}

}  // namespace latent::develop
