#include "render/sampling/bilinear_warp.h"

#include <algorithm>
#include <cmath>

namespace latent::render {

namespace {

// The integral of a + (b - a) x from 0 to x, and where it is q.
float ramp(float a, float b, float x) { return x * (a + 0.5f * x * (b - a)); }
float where_ramp_is(float a, float b, float q) {
    const float root = std::sqrt(std::max(0.0f, a * a + 2 * q * (b - a)));
    return a + root > 0 ? std::clamp(2 * q / (a + root), 0.0f, 1.0f) : 0.5f;
}

// The last i < n - 1 with f(i) <= x, or 0; f ascends.
template <class F>
std::uint32_t cell_below(std::uint32_t n, float x, F f) {
    std::uint32_t low = 0, high = n - 1;
    while (high - low > 1) {
        const std::uint32_t middle = (low + high) / 2;
        (f(middle) <= x ? low : high) = middle;
    }
    return low;
}

// Along one side: the point below, and the share of the way to the next.
struct LatticeStep {
    std::uint32_t i;
    float at;
};
LatticeStep step_of(float x, std::uint32_t points) {
    const float scaled = std::clamp(x, 0.0f, 1.0f) * static_cast<float>(points - 1);
    const std::uint32_t i = std::min(static_cast<std::uint32_t>(scaled), points - 2);
    return {i, scaled - static_cast<float>(i)};
}

float between(float a, float b, float at) { return (1 - at) * a + at * b; }

}  // namespace

LatticeCell lattice_cell(std::uint32_t width, std::uint32_t height, const Vec2f& place) {
    const auto [x, s] = step_of(place.x, width);
    const auto [y, t] = step_of(place.y, height);
    const std::size_t first = std::size_t{y} * width + x;
    return {{first, first + 1, first + width, first + width + 1}, {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t}};
}

float bilinear(std::span<const float> values, std::uint32_t width, std::uint32_t height, const Vec2f& place) {
    const LatticeCell cell = lattice_cell(width, height, place);
    float sum = 0;
    for (std::size_t c = 0; c < 4; ++c) sum += cell.share[c] * values[cell.corner[c]];
    return sum;
}

BilinearWarp::BilinearWarp(std::span<const float> values, std::uint32_t width, std::uint32_t height)
    : width_(width), height_(height), values_(values.begin(), values.end()), in_row_(values.size()) {
    const std::size_t points = std::size_t{width} * height;
    std::vector<double> in_row(points), below(height);
    for (std::size_t first = 0; first < values_.size(); first += points) {
        const auto table = std::span(values_).subspan(first, points);
        if (std::ranges::none_of(table, [](float x) { return x > 0; })) std::ranges::fill(table, 1.0f);
        for (std::size_t y = 0; y < height; ++y) {
            double sum = 0;
            for (std::size_t x = 0; x < width; ++x) {
                const std::size_t i = y * width + x;
                if (x > 0) sum += 0.5 * (static_cast<double>(table[i - 1]) + static_cast<double>(table[i])) / (width - 1);
                in_row[i] = sum;
            }
            below[y] = y == 0 ? 0 : below[y - 1] + 0.5 * (in_row[y * width - 1] + sum) / (height - 1);
        }
        const double scale = 1 / below.back();
        for (float& x : table) x = static_cast<float>(static_cast<double>(x) * scale);
        for (std::size_t i = 0; i < points; ++i) in_row_[first + i] = static_cast<float>(in_row[i] * scale);
        for (const double b : below) below_.push_back(static_cast<float>(b * scale));
    }
}

Vec2f BilinearWarp::sample(const TableMixture& m, float u, float v) const {
    const float dx = 1 / static_cast<float>(width_ - 1), dy = 1 / static_cast<float>(height_ - 1);
    const float up = v * below(m, height_ - 1);
    const std::uint32_t y = cell_below(height_, up, [&](std::uint32_t i) { return below(m, i); });
    const float r0 = row(m, y), r1 = row(m, y + 1);
    const float t = where_ramp_is(r0, r1, (up - below(m, y)) / dy);
    const float along = u * between(r0, r1, t);
    const auto integral = [&](std::uint32_t i) { return between(in_row(m, i, y), in_row(m, i, y + 1), t); };
    const std::uint32_t x = cell_below(width_, along, integral);
    const float c0 = between(value(m, x, y), value(m, x, y + 1), t), c1 = between(value(m, x + 1, y), value(m, x + 1, y + 1), t);
    const float s = where_ramp_is(c0, c1, (along - integral(x)) / dx);
    return {(static_cast<float>(x) + s) * dx, (static_cast<float>(y) + t) * dy};
}

Vec2f BilinearWarp::invert(const TableMixture& m, const Vec2f& place) const {
    const float dx = 1 / static_cast<float>(width_ - 1), dy = 1 / static_cast<float>(height_ - 1);
    const auto [x, s] = step_of(place.x, width_);
    const auto [y, t] = step_of(place.y, height_);
    const float r0 = row(m, y), r1 = row(m, y + 1), whole = between(r0, r1, t), all = below(m, height_ - 1);
    const float c0 = between(value(m, x, y), value(m, x, y + 1), t), c1 = between(value(m, x + 1, y), value(m, x + 1, y + 1), t);
    const float along = between(in_row(m, x, y), in_row(m, x, y + 1), t) + dx * ramp(c0, c1, s);
    return {whole > 0 ? along / whole : 0.5f, (below(m, y) + dy * ramp(r0, r1, t)) / all};
}

float BilinearWarp::density(const TableMixture& m, const Vec2f& place) const {
    const auto [x, s] = step_of(place.x, width_);
    const auto [y, t] = step_of(place.y, height_);
    return between(between(value(m, x, y), value(m, x + 1, y), s), between(value(m, x, y + 1), value(m, x + 1, y + 1), s), t);
}

}  // namespace latent::render
