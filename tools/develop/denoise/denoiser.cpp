#include "tools/develop/denoise/denoiser.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "tools/develop/denoise/row_loops.h"

namespace latent::develop {

namespace {

constexpr std::int64_t kRadius = 5;          // of neighbours
constexpr std::int64_t kPatch = 1;           // of what is compared around a pixel and its neighbour
constexpr std::int64_t kVarianceRadius = 2;  // of what a variance is measured in
static_assert(kDenoiseReach == kRadius + kPatch + kVarianceRadius);

constexpr float kNormal = 0.2f, kDepth = 0.04f, kAlbedo = 0.1f;  // differences of surfaces: of depth, relative and per pixel
constexpr float kSquares = 6;                                    // of these, where weights end

// Numbers of a rectangle of pixels.
class Plane {
 public:
    explicit Plane(const PixelRect& pixels, float value = 0)
        : pixels_(pixels), values_(static_cast<std::size_t>(pixels.width() * pixels.height()), value) {}
    // So that row(y)[x] is that of pixel (x, y).
    float* row(std::int64_t y) { return values_.data() + (y - pixels_.y0) * pixels_.width() - pixels_.x0; }
    const float* row(std::int64_t y) const { return values_.data() + (y - pixels_.y0) * pixels_.width() - pixels_.x0; }
    const PixelRect& pixels() const { return pixels_; }

 private:
    PixelRect pixels_;
    std::vector<float> values_;
};

PixelRect grown(const PixelRect& r, std::int64_t by) { return {r.x0 - by, r.y0 - by, r.x1 + by, r.y1 + by}; }
PixelRect moved(const PixelRect& r, std::int64_t x, std::int64_t y) { return {r.x0 + x, r.y0 + y, r.x1 + x, r.y1 + y}; }

template <class Value>  // of the values of a pixel
Plane plane_of(const PixelRect& pixels, std::span<const float> values, std::size_t outputs, const Value& value) {
    Plane plane(pixels);
    const float* at = values.data();
    for (std::int64_t y = pixels.y0; y < pixels.y1; ++y) {
        float* const row = plane.row(y);
        for (std::int64_t x = pixels.x0; x < pixels.x1; ++x, at += outputs) row[x] = value(at);
    }
    return plane;
}

// Means over squares of 2 `radius` + 1, of their pixels that `plane` has. Each is added up in the same order, wherever the plane
// begins.
Plane means_around(const Plane& plane, const PixelRect& wanted, std::int64_t radius) {
    const PixelRect& all = plane.pixels();
    const PixelRect rows = intersection({wanted.x0, wanted.y0 - radius, wanted.x1, wanted.y1 + radius}, all);
    Plane across(rows), means(wanted);
    for (std::int64_t y = rows.y0; y < rows.y1; ++y) {
        const float* const from = plane.row(y);
        float* const to = across.row(y);
        for (std::int64_t d = -radius; d <= radius; ++d) {
            const std::int64_t first = std::max(rows.x0, all.x0 - d), end = std::min(rows.x1, all.x1 - d);
            if (first < end) add_row(static_cast<std::size_t>(end - first), from + first + d, to + first);
        }
    }
    for (std::int64_t y = wanted.y0; y < wanted.y1; ++y) {
        float* const to = means.row(y);
        const std::int64_t first = std::max(y - radius, rows.y0), end = std::min(y + radius + 1, rows.y1);
        for (std::int64_t other = first; other < end; ++other)
            add_row(static_cast<std::size_t>(wanted.width()), across.row(other) + wanted.x0, to + wanted.x0);
        for (std::int64_t x = wanted.x0; x < wanted.x1; ++x) {
            const std::int64_t columns = std::min(x + radius + 1, all.x1) - std::max(x - radius, all.x0);
            to[x] /= static_cast<float>(columns * (end - first));
        }
    }
    return means;
}

struct Channel {
    Plane value, variance;
    Plane sum, variance_sum;  // of neighbours, with their weights and the squares of these
};

class Denoiser {
 public:
    Denoiser(const DenoisedValues& values, const DenoisedValues::Part& part, const PixelRect& held, std::span<const float> pixels,
             const PixelRect& wanted)
        : held_(held), wanted_(wanted), with_variance_(values.variance), weights_(wanted, 1) {
        const auto plane = [&](std::size_t place) {
            return plane_of(held, pixels, values.outputs, [place](const float* pixel) {
                return std::isfinite(pixel[place]) ? pixel[place] : 0.0f;  // the depth of what is infinitely far
            });
        };
        const PixelRect compared = intersection(grown(wanted, kRadius + kPatch), held);
        for (std::size_t c = 0; c < values.channels; ++c) {
            const Plane squares = plane_of(held, pixels, values.outputs, [&, c](const float* pixel) {
                const float error = (pixel[part.half0 + c] - pixel[part.half1 + c]) * 0.5f;
                return error * error;
            });
            channels_.push_back(
                {plane(part.value + c), means_around(squares, compared, kVarianceRadius), Plane(wanted), Plane(wanted)});
            Channel& channel = channels_.back();
            for (std::int64_t y = wanted.y0; y < wanted.y1; ++y) {
                std::copy(channel.value.row(y) + wanted.x0, channel.value.row(y) + wanted.x1, channel.sum.row(y) + wanted.x0);
            }
        }
        const auto add = [&](const std::optional<std::size_t>& first, std::vector<Plane>& planes) {
            for (std::size_t i = 0; first && i < 3; ++i) planes.push_back(plane(*first + i));
        };
        add(values.albedo, albedo_);
        add(values.normal, normal_);
        if (values.depth) depth_.push_back(plane(*values.depth));
        if (values.weight) {
            known_.push_back(plane_of(held, pixels, values.outputs,
                                      [&](const float* pixel) { return pixel[*values.weight] != 0 ? 1.0f : 0.0f; }));
        }
        for (std::int64_t dy = 0; dy <= kRadius; ++dy) {
            for (std::int64_t dx = dy > 0 ? -kRadius : 1; dx <= kRadius; ++dx) {
                if (dx * dx + dy * dy <= kRadius * (kRadius + 1)) add_neighbours(dx, dy);
            }
        }
    }

    // The value of pixel (x, y), which keeps 1 - amount of its own.
    float value(std::size_t c, std::int64_t x, std::int64_t y, float amount) const {
        const Channel& channel = channels_[c];
        return amount * (channel.sum.row(y)[x] / weights_.row(y)[x]) + (1 - amount) * channel.value.row(y)[x];
    }
    float variance(std::size_t c, std::int64_t x, std::int64_t y, float amount) const {
        const Channel& channel = channels_[c];
        const float each = amount / weights_.row(y)[x], own = each + 1 - amount;
        return each * each * channel.variance_sum.row(y)[x] + own * own * channel.variance.row(y)[x];
    }

 private:
    void add_neighbours(std::int64_t dx, std::int64_t dy);
    void add_weighted(const Plane& weights, std::int64_t dx, std::int64_t dy, std::int64_t weight_x, std::int64_t weight_y);
    void weigh_surfaces(std::size_t n, std::int64_t dx, std::int64_t dy, std::int64_t y, std::int64_t x, float* weights) const;

    PixelRect held_, wanted_;
    bool with_variance_;
    std::vector<Channel> channels_;
    std::vector<Plane> albedo_, normal_, depth_;  // three, three, one; or none
    std::vector<Plane> known_;                    // one or none: 1 where a pixel has camera records, else 0
    Plane weights_;                               // sums; a pixel's own is 1
};

// [Welch47]: the difference of two means over its standard error, squared; its mean over the channels and over a patch around both.
// Either pixel of a pair is a neighbour of the other with the same weight, which stands at the first: the other is (dx, dy)
// further.
void Denoiser::add_neighbours(std::int64_t dx, std::int64_t dy) {
    const PixelRect both = intersection(held_, moved(held_, -dx, -dy));  // where the other is in the picture, too
    const PixelRect others = moved(wanted_, -dx, -dy);
    const PixelRect either{std::min(wanted_.x0, others.x0), std::min(wanted_.y0, others.y0), std::max(wanted_.x1, others.x1),
                           std::max(wanted_.y1, others.y1)};
    const PixelRect pairs = intersection(either, both), around = intersection(grown(pairs, kPatch), both);
    if (pairs.empty()) return;
    Plane squares(around);
    const float share = 1 / static_cast<float>(channels_.size());
    for (const Channel& channel : channels_) {
        for (std::int64_t y = around.y0; y < around.y1; ++y) {
            const float *const a = channel.value.row(y) + around.x0, *const v = channel.variance.row(y) + around.x0,
                               *const b = channel.value.row(y + dy) + around.x0 + dx,
                               *const w = channel.variance.row(y + dy) + around.x0 + dx;
            add_differences(static_cast<std::size_t>(around.width()), share, a, b, v, w, squares.row(y) + around.x0);
        }
    }
    Plane weights = means_around(squares, pairs, kPatch);
    const auto n = static_cast<std::size_t>(pairs.width());
    for (std::int64_t y = pairs.y0; y < pairs.y1; ++y) {
        float* const weight = weights.row(y) + pairs.x0;
        weigh_differences(n, weight);
        weigh_surfaces(n, dx, dy, y, pairs.x0, weight);
        for (const Plane& known : known_) {
            multiply_row(n, known.row(y) + pairs.x0, weight);
            multiply_row(n, known.row(y + dy) + pairs.x0 + dx, weight);
        }
    }
    add_weighted(weights, dx, dy, 0, 0);
    add_weighted(weights, -dx, -dy, -dx, -dy);
}

// The neighbours (dx, dy) further, with the weights that stand (weight_x, weight_y) further.
void Denoiser::add_weighted(const Plane& weights, std::int64_t dx, std::int64_t dy, std::int64_t weight_x, std::int64_t weight_y) {
    const PixelRect pixels = intersection(wanted_, moved(weights.pixels(), -weight_x, -weight_y));
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

// Of n pixels from (x, y) on, and their neighbours.
void Denoiser::weigh_surfaces(std::size_t n, std::int64_t dx, std::int64_t dy, std::int64_t y, std::int64_t x,
                              float* weights) const {
    const auto vectors = [](const std::vector<Plane>& planes, std::int64_t at_x, std::int64_t at_y) {
        return Vectors{planes[0].row(at_y) + at_x, planes[1].row(at_y) + at_x, planes[2].row(at_y) + at_x};
    };
    for (const auto& [planes, width] : {std::pair(&albedo_, kAlbedo), {&normal_, kNormal}}) {
        if (!planes->empty())
            weigh_vectors(n, 1 / (kSquares * width * width), vectors(*planes, x, y), vectors(*planes, x + dx, y + dy), weights);
    }
    const float scale = 1 / (kSquares * kDepth * kDepth * static_cast<float>(dx * dx + dy * dy));
    if (!depth_.empty()) weigh_depths(n, scale, depth_[0].row(y) + x, depth_[0].row(y + dy) + x + dx, weights);
}

}  // namespace

PixelRect read_by_denoiser(const PixelRect& wanted, const PixelRect& picture) {
    return intersection(grown(wanted, kDenoiseReach), picture);
}

DenoisedValues DenoisedValues::find(const std::vector<std::string>& names) {
    DenoisedValues values;
    values.outputs = names.size();
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
    std::vector<float> out;
    out.reserve(static_cast<std::size_t>(wanted.width() * wanted.height()) * values.outputs);
    for (std::int64_t y = wanted.y0; y < wanted.y1; ++y) {
        const auto first = static_cast<std::size_t>((y - held.y0) * held.width() + wanted.x0 - held.x0) * values.outputs;
        const std::span<const float> row = pixels.subspan(first, static_cast<std::size_t>(wanted.width()) * values.outputs);
        out.insert(out.end(), row.begin(), row.end());
    }
    const auto for_each_value = [&](const auto& change) {
        float* pixel = out.data();
        for (std::int64_t y = wanted.y0; y < wanted.y1; ++y) {
            for (std::int64_t x = wanted.x0; x < wanted.x1; ++x, pixel += values.outputs) {
                for (std::size_t c = 0; c < values.channels; ++c) change(c, x, y, pixel);
            }
        }
    };
    const std::vector<DenoisedValues::Part> parts = values.lights.empty() ? std::vector{values.picture} : values.lights;
    for (const DenoisedValues::Part& part : parts) {
        const Denoiser denoiser(values, part, held, pixels, wanted);
        const bool is_first = part.value == parts.front().value;
        for_each_value([&](std::size_t c, std::int64_t x, std::int64_t y, float* pixel) {
            const float value = denoiser.value(c, x, y, share);
            pixel[part.value + c] = value;
            if (part.value != values.picture.value) pixel[c] = is_first ? value : pixel[c] + value;
            if (!values.variance) return;
            const float variance = denoiser.variance(c, x, y, share);
            float& sum = pixel[*values.variance + c];
            sum = is_first ? variance : sum + variance;
        });
    }
    return out;
}

}  // namespace latent::develop
