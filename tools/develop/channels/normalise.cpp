#include "tools/develop/channels/normalise.h"

#include <algorithm>
#include <limits>

#include "color/rgb_space.h"

namespace latent::develop {

namespace {

template <bool kCamera, bool kLight>
std::size_t normalise(const SumRow& row, int stride, int channels, float* out) {
    std::size_t few = 0;
    const double* camera = row.camera;
    const double* light = row.light;
    for (std::size_t i = 0; i < row.min_weight.size(); ++i, out += channels) {
        double per_weight = 0;
        if constexpr (kCamera) {
            const double weight = camera[channels];
            const bool enough = weight > 0 && weight >= row.min_weight[i];
            per_weight = enough ? 1 / weight : 0;
            few += enough ? 0 : 1;
        }
        for (int c = 0; c < channels; ++c) {
            double sum = 0;
            if constexpr (kCamera) sum = camera[c] * per_weight;
            if constexpr (kLight) sum += light[c] * row.light_scale[i];
            out[c] = static_cast<float>(sum);
        }
        if constexpr (kCamera) camera += stride;
        if constexpr (kLight) light += stride;
    }
    return few;
}

template <bool kCamera, bool kLight>
std::size_t normalise_any(const SumRow& row, float* out) {
    const RowLayout& layout = row.layout;
    if (layout.stride() == 4 && layout.channels == 3) return normalise<kCamera, kLight>(row, 4, 3, out);  // the loop unrolled
    return normalise<kCamera, kLight>(row, layout.stride(), layout.channels, out);
}

constexpr double kMinShareOfHits = 1e-3;  // below, depths are those of nothing: a filter with negative lobes sums up to anything

// AOVs of a pixel; null: it has too little weight.
void finish_aovs(const RowLayout& layout, const double* camera, float* out) {
    const Layers& layers = layout.layers;
    const auto put = [&out](double value) { *out++ = static_cast<float>(value); };
    const auto mean = [&](int entry) { return camera ? camera[entry] / camera[layout.share()] : 0; };
    if (layers.albedo) {  // linear sRGB within [0,1], which is what denoisers take
        const int at = layout.albedo();
        for (const double x : color::RgbSpace::srgb().rgb_from_xyz* std::array{mean(at), mean(at + 1), mean(at + 2)})
            put(std::clamp(x, 0.0, 1.0));
    }
    for (int i = 0; i < 3 && layers.normal; ++i) put(mean(layout.normal() + i));
    // The mean of what is hit, where that has some share of the pixel.
    const auto mean_of_hits = [&](int entry, int hits, double none) {
        return mean(hits) >= kMinShareOfHits ? camera[entry] / camera[hits] : none;
    };
    if (layers.depth) put(mean_of_hits(layout.depth(), layout.depth() + 1, std::numeric_limits<double>::infinity()));
    for (int i = 0; i < 3 && layers.position; ++i) put(mean_of_hits(layout.position() + i, layout.position() + 3, 0));
    for (int i = 1; i < 3 && layers.id; ++i) put(camera ? camera[layout.chosen() + i] : 0);
    for (std::size_t i = 0; i < layers.columns.size(); ++i) put(mean_of_hits(layout.column(i), layout.column(i) + 1, 0));
}

// A pixel and all that goes with it; null sums are zeros. True if it has enough weight.
bool finish_pixel(const SumRow& row, std::size_t i, const double* camera, const double* light, float* out) {
    const RowLayout& layout = row.layout;
    const int n = layout.channels;
    const double weight = camera ? camera[layout.share()] : 0, least = camera ? layout.min_divisor(camera) : 0;
    const bool enough = weight > 0 && least >= row.min_weight[i];
    const auto put = [&out](double value) { *out++ = static_cast<float>(value); };
    const auto per_divisor = [&](int c) {  // a response that no record has met is 0, and so is its sum
        return enough && camera[layout.divisor(c)] > 0 ? 1 / camera[layout.divisor(c)] : 0;
    };
    const auto camera_value = [&](int c) { return camera ? camera[c] * per_divisor(c) : 0; };
    for (int time = 0; time < (layout.layers.noisy ? 2 : 1); ++time) {
        for (int c = 0; c < n; ++c) put(camera_value(c) + (light ? light[c] * row.light_scale[i] : 0));
    }
    for (int c = 0; c < n && layout.layers.variance; ++c) {
        // sum over samples of (w (s - c C))^2, which rounding must not make negative
        const double value = camera_value(c);
        const double sum = camera ? camera[layout.squares() + c] - 2 * value * camera[layout.products() + c] +
                                        value * value * camera[layout.divisor_square(c)]
                                  : 0;
        const double scale = camera ? per_divisor(c) : 0;
        put(std::max(0.0, sum) * scale * scale);
    }
    if (layout.layers.weight) put(weight);
    if (layout.layers.count) put(camera ? camera[layout.counter()] : 0);
    // Both halves of sums whose values begin at `whole`, and those of half 0 at `first`.
    const auto put_halves = [&](int whole, int first) {
        for (int half = 0; half < 2 && layout.layers.halves; ++half) {
            const auto sum_of = [half](const double* sums, int all, int of_first) {
                return half == 0 ? sums[of_first] : sums[all] - sums[of_first];
            };
            for (int c = 0; c < n; ++c) {
                const int entry = layout.divisor(c);
                const double divisor = camera ? sum_of(camera, entry, layout.half() + entry) : 0;
                const bool counts = divisor > 0 && divisor >= 0.5 * row.min_weight[i];
                const double from_camera = counts ? sum_of(camera, whole + c, first + c) / divisor : 0;
                const double scale = row.light_scale[i] * row.half_scale[static_cast<std::size_t>(half)];
                put(from_camera + (light ? sum_of(light, whole + c, first + c) * scale : 0));
            }
        }
    };
    put_halves(0, layout.half());
    for (std::size_t group = 0; group < layout.lights.size(); ++group) {
        const int first = layout.light(group);
        for (int c = 0; c < n; ++c)
            put((camera ? camera[first + c] * per_divisor(c) : 0) + (light ? light[first + c] * row.light_scale[i] : 0));
        put_halves(first, layout.light_half(group));
    }
    if (layout.layers.aovs()) finish_aovs(layout, enough ? camera : nullptr, out);
    return enough;
}

std::size_t normalise_layers(const SumRow& row, float* out) {
    std::size_t few = 0;
    const auto stride = static_cast<std::size_t>(row.layout.stride()), outputs = static_cast<std::size_t>(row.layout.outputs());
    for (std::size_t i = 0; i < row.min_weight.size(); ++i) {
        const bool enough = finish_pixel(row, i, row.camera ? row.camera + i * stride : nullptr,
                                         row.light ? row.light + i * stride : nullptr, out + i * outputs);
        few += row.camera && !enough ? 1 : 0;
    }
    return few;
}

}  // namespace

std::size_t normalise_row(const SumRow& row, float* out) {
    if (row.layout.layers.any() || row.layout.ratio) return normalise_layers(row, out);
    if (row.camera && row.light) return normalise_any<true, true>(row, out);
    if (row.camera) return normalise_any<true, false>(row, out);
    if (row.light) return normalise_any<false, true>(row, out);
    return normalise_any<false, false>(row, out);
}

}  // namespace latent::develop
