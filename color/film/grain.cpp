#include "color/film/grain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "color/film/push.h"
#include "color/film/spectra.h"

namespace latent::film {
namespace {

constexpr double kCoarsest = 4096;     // um
constexpr int kFinest = 11;            // 2 um
constexpr double kCloud = 6;           // um, half the width of a dye cloud
constexpr double kAperture = 42.5396;  // um, side of the square of the same area as the aperture of 48 um

// Twice the integral of the tent of unit area over -kCloud .. kCloud: 0 far to the left, t far to the right.
double twice_integrated(double t) {
    constexpr double w = kCloud;
    if (t <= -w) return 0;
    if (t >= w) return t;
    const double to_end = w - std::abs(t);
    return std::max(t, 0.0) + to_end * to_end * to_end / (6 * w * w);
}

// How much a pixel from a to b, blurred by the cloud, sees of a cell from c to d: parts of 1.
double part(double a, double b, double c, double d) {
    const auto r = twice_integrated;
    return (r(b - c) - r(b - d) - r(a - c) + r(a - d)) / (b - a);
}

// Variance of a mean of this width, of noise of unit power along one axis [1/um].
double variance(double width) {
    constexpr double kStep = 0.25;
    double sum = 0;
    for (double at = -kCloud - width; at < width + kCloud; at += kStep) {
        const double seen = part(-width / 2, width / 2, at, at + kStep);
        sum += seen * seen / kStep;
    }
    return sum;
}

std::uint64_t mixed(std::uint64_t z) {  // [SplitMix64]
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
}

// Four numbers of mean 0 and variance 1, nearly normal: of each 16 bits, how many are set.
struct Four {
    float n[4];
};
Four normals(std::uint64_t key, std::int64_t x, std::int64_t y) {
    std::uint64_t b = mixed(key ^ (static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15 + (static_cast<std::uint64_t>(y) << 32)));
    b -= (b >> 1) & 0x5555555555555555;
    b = (b & 0x3333333333333333) + ((b >> 2) & 0x3333333333333333);
    b = (b + (b >> 4)) & 0x0f0f0f0f0f0f0f0f;
    b = (b + (b >> 8)) & 0x00ff00ff00ff00ff;
    const auto one = [&](int shift) { return (static_cast<float>(static_cast<std::int32_t>((b >> shift) & 0xff)) - 8) * 0.5F; };
    return {{one(0), one(16), one(32), one(48)}};
}

std::uint64_t key_of(std::uint64_t seed, std::uint64_t layer, int level) {
    return mixed(seed + 0x9e3779b97f4a7c15 * (64 * layer + static_cast<std::uint64_t>(level) + 1));
}

constexpr std::int64_t floor_half(std::int64_t v) { return v >> 1; }

// Of the sheet that stands for films whose own was not published.
Columns shape_for(const Material& film) {
    return common_table(film.positive() ? "kodak_ektachrome_100d.grain" : "kodak_5219.grain");
}
constexpr const char* kLayer[] = {"r", "g", "b"};

// The least densities of the layers, in the data sheet's densitometer.
Triple least_densities(const Columns& curves) {
    Triple least;
    for (std::size_t c = 0; c < 3; ++c) least[c] = std::ranges::min(curves[kLayer[c]]);
    return least;
}

}  // namespace

Result<std::array<Table1, 3>> granularity(const Material& film, double pushed) {
    constexpr double kMost = 4.5, kStep = 0.05;
    std::array<Table1, 3> out;
    const auto fill = [&](std::size_t c, auto sigma) {
        out[c] = {0, static_cast<float>(1 / kStep), {}};
        for (int i = 0; i <= static_cast<int>(kMost / kStep); ++i)
            out[c].y.push_back(static_cast<float>(push_contrast(pushed) * sigma(i * kStep) / 1000));
    };
    if (!film.colour) {  // as the square root of the density, [Nutting]; the sheet gives it at density 1
        if (film.rms == 0) return Error{ErrorCode::kUnsupported, film.title + ": its granularity is not known"};
        for (std::size_t c = 0; c < 3; ++c) fill(c, [&](double density) { return film.rms * std::sqrt(density); });
        return out;
    }
    const Result<std::optional<Columns>> own = find_table(film, "grain");
    if (!own) return own.error();
    if (!*own && film.rms == 0) return Error{ErrorCode::kUnsupported, film.title + ": its granularity is not known"};
    const Result<Columns> curves = need_table(film, "curves", {"r", "g", "b"});
    if (!curves) return curves.error();
    const Columns shape = *own ? **own : shape_for(film);
    const Columns shape_curves = common_table(film.positive() ? "kodak_ektachrome_100d.curves" : "kodak_5219.curves");
    const Triple base = least_densities(*own ? *curves : shape_curves);
    const auto plain = [&](std::size_t c, double above_base) {
        return interpolated(base[c] + above_base, shape.values[0], shape[kLayer[c]]);
    };
    double scale = 1;
    if (!*own) {  // what the eye sees of the three layers at density 1 is the rms of the sheet
        constexpr double kVisual[] = {0.3, 0.6, 0.1};
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double seen = kVisual[c] * plain(c, film.positive() ? 1 - base[c] : 1);
            sum += seen * seen;
        }
        scale = film.rms / std::sqrt(sum);
    }
    for (std::size_t c = 0; c < 3; ++c) fill(c, [&](double density) { return scale * plain(c, density); });
    return out;
}

GrainField::GrainField(std::uint64_t seed, double pixel_um, int layers) : seed_(seed), pixel_um_(pixel_um), layers_(layers) {
    while (level_ < kFinest && kCoarsest / static_cast<double>(1 << level_) > pixel_um / 2) ++level_;
    cell_um_ = kCoarsest / static_cast<double>(1 << level_);
    strength_ = std::sqrt(variance(pixel_um) / variance(kAperture));
}

GrainField::Span1 GrainField::seen_by(std::int64_t pixel) const {
    const double a = static_cast<double>(pixel) * pixel_um_, b = a + pixel_um_;
    Span1 span;
    span.first = static_cast<std::int64_t>(std::floor((a - kCloud) / cell_um_));
    const auto last = static_cast<std::int64_t>(std::floor((b + kCloud) / cell_um_));
    double squares = 0;
    for (std::int64_t i = span.first; i <= last; ++i) {
        const double seen = part(a, b, static_cast<double>(i) * cell_um_, static_cast<double>(i + 1) * cell_um_);
        squares += seen * seen;
        span.weights.push_back(static_cast<float>(seen));
    }
    // The cells are not infinitely small, so what a pixel sees depends a little on where it lies between them: made up for.
    const double factor = strength_ / std::sqrt(squares);
    for (float& w : span.weights) w = static_cast<float>(static_cast<double>(w) * factor);
    return span;
}

// Haar refinement: four children are their parent plus independent details, and their mean is their parent. Values have variance 1:
// those of a level are twice as strong as their parents', in proportion to the reciprocal of their width.
void GrainField::cells(std::uint64_t layer, std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1,
                       Scratch& scratch) const {
    struct Area {
        std::int64_t x0, y0, x1, y1;  // inclusive
    };
    std::array<Area, kFinest + 1> areas;
    areas[static_cast<std::size_t>(level_)] = {x0, y0, x1, y1};
    for (int level = level_; level-- > 0;) {
        const Area& below = areas[static_cast<std::size_t>(level) + 1];
        areas[static_cast<std::size_t>(level)] = {floor_half(below.x0), floor_half(below.y0), floor_half(below.x1),
                                                  floor_half(below.y1)};
    }
    const auto width_of = [](const Area& a) { return static_cast<std::size_t>(a.x1 - a.x0 + 1); };
    scratch.coarse.resize(width_of(areas[0]) * static_cast<std::size_t>(areas[0].y1 - areas[0].y0 + 1));
    for (std::int64_t y = areas[0].y0; y <= areas[0].y1; ++y) {
        for (std::int64_t x = areas[0].x0; x <= areas[0].x1; ++x)
            scratch.coarse[static_cast<std::size_t>(y - areas[0].y0) * width_of(areas[0]) +
                           static_cast<std::size_t>(x - areas[0].x0)] = normals(key_of(seed_, layer, 0), x, y).n[0];
    }
    for (int level = 0; level < level_; ++level) {
        const Area& from = areas[static_cast<std::size_t>(level)];
        const Area& to = areas[static_cast<std::size_t>(level) + 1];
        const std::uint64_t key = key_of(seed_, layer, level + 1);
        const std::size_t width = width_of(to);
        scratch.fine.resize(width * static_cast<std::size_t>(to.y1 - to.y0 + 1));
        for (std::int64_t y = from.y0; y <= from.y1; ++y) {
            const float* parents = &scratch.coarse[static_cast<std::size_t>(y - from.y0) * width_of(from)];
            for (std::int64_t x = from.x0; x <= from.x1; ++x) {
                // Of variance 1 as children; the sum of four independent halves.
                const Four d = normals(key, x, y);
                const float p = parents[x - from.x0];
                const float child[4] = {0.5F * (p + d.n[0] + d.n[1] + d.n[2]), 0.5F * (p + d.n[0] - d.n[1] - d.n[2]),
                                        0.5F * (p - d.n[0] + d.n[1] - d.n[2]), 0.5F * (p - d.n[0] - d.n[1] + d.n[2])};
                for (int i = 0; i < 4; ++i) {
                    const std::int64_t cx = 2 * x + (i & 1), cy = 2 * y + (i >> 1);
                    if (cx < to.x0 || cx > to.x1 || cy < to.y0 || cy > to.y1) continue;
                    scratch.fine[static_cast<std::size_t>(cy - to.y0) * width + static_cast<std::size_t>(cx - to.x0)] = child[i];
                }
            }
        }
        std::swap(scratch.coarse, scratch.fine);
    }
    std::swap(scratch.coarse, scratch.fine);  // in any case `fine`
}

void GrainField::fill(int x0, int y0, int width, int height, const std::array<float*, 3>& planes, Scratch& scratch) const {
    std::vector<Span1> columns, rows;
    for (int x = 0; x < width; ++x) columns.push_back(seen_by(x0 + x));
    for (int y = 0; y < height; ++y) rows.push_back(seen_by(y0 + y));
    const auto last_of = [](const Span1& span) { return span.first + static_cast<std::int64_t>(span.weights.size()) - 1; };
    const std::int64_t cx0 = columns.front().first, cx1 = last_of(columns.back()), cy0 = rows.front().first,
                       cy1 = last_of(rows.back());
    const auto pixels = static_cast<std::size_t>(width);
    const auto cell_columns = static_cast<std::size_t>(cx1 - cx0 + 1), cell_rows = static_cast<std::size_t>(cy1 - cy0 + 1);
    for (int layer = 0; layer < layers_; ++layer) {
        cells(static_cast<std::uint64_t>(layer), cx0, cy0, cx1, cy1, scratch);
        scratch.sums.resize(pixels * cell_rows);
        for (std::size_t r = 0; r < cell_rows; ++r) {
            const float* cell = &scratch.fine[r * cell_columns];
            for (std::size_t x = 0; x < pixels; ++x) {
                const Span1& span = columns[x];
                const float* seen = cell + (span.first - cx0);
                float sum = 0;
                for (std::size_t i = 0; i < span.weights.size(); ++i) sum += span.weights[i] * seen[i];
                scratch.sums[r * pixels + x] = sum;
            }
        }
        for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
            float* out = planes[static_cast<std::size_t>(layer)] + y * pixels;
            std::fill_n(out, pixels, 0.0F);
            for (std::size_t i = 0; i < rows[y].weights.size(); ++i) {
                const float weight = rows[y].weights[i];
                const float* row = &scratch.sums[(static_cast<std::size_t>(rows[y].first - cy0) + i) * pixels];
                for (std::size_t x = 0; x < pixels; ++x) out[x] += weight * row[x];
            }
        }
    }
}

std::size_t GrainField::scratch_bytes(int width, int height) const {
    const auto along = [&](int n) { return static_cast<std::size_t>((n * pixel_um_ + 2 * kCloud) / cell_um_) + 4; };
    const std::size_t spans = static_cast<std::size_t>(width + height) * (sizeof(Span1) + 16 + 4 * along(1));
    return 4 * (2 * along(width) * along(height) + static_cast<std::size_t>(width) * along(height)) + spans;
}

}  // namespace latent::film
