#include "color/film/grain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/mix.h"
#include "color/film/mono.h"
#include "color/film/push.h"
#include "color/film/spectra.h"
#include "color/film/stock.h"
#include "color/power_of_ten.h"

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

// Numbers of mean 8 and variance 4, nearly normal: of each 16 bits, how many are set.
struct Counts {
    std::int32_t n[4];
};
Counts counts(std::uint64_t key, std::int64_t x, std::int64_t y) {
    std::uint64_t b = mix(key ^ (static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15 + (static_cast<std::uint64_t>(y) << 32)));
    b -= (b >> 1) & 0x5555555555555555;
    b = (b & 0x3333333333333333) + ((b >> 2) & 0x3333333333333333);
    b = (b + (b >> 4)) & 0x0f0f0f0f0f0f0f0f;
    b = (b + (b >> 8)) & 0x00ff00ff00ff00ff;
    const auto one = [&](int shift) { return static_cast<std::int32_t>((b >> shift) & 0xff); };
    return {{one(0), one(16), one(32), one(48)}};
}

std::uint64_t key_of(std::uint64_t seed, std::uint64_t layer, int level) {
    return mix(seed + 0x9e3779b97f4a7c15 * (64 * layer + static_cast<std::uint64_t>(level) + 1));
}

constexpr std::int64_t floor_half(std::int64_t v) { return v >> 1; }

// The shape from the sheet that stands for films whose own was not published.
Columns shape_for(const Material& film) {
    return common_table(film.positive() ? "kodak_ektachrome_100d.grain" : "kodak_5219.grain");
}
constexpr const char* kLayer[] = {"r", "g", "b"};

// What a densitometer of these weights reads of the dyes, and by how much it changes with the amount of each.
struct Reading {
    double density = 0;
    Triple slopes{};
};
Reading reading_of(const Stock& film, const Curve& weights, const Triple& amounts) {
    const Curve t = transmittance(film.density(amounts));
    Curve seen;
    for (std::size_t i = 0; i < kNm; ++i) seen[i] = t[i] * weights[i];
    const double light = std::accumulate(seen.begin(), seen.end(), 0.0);
    Reading out{-color::log10_of(light), {}};
    for (std::size_t c = 0; c < 3; ++c) out.slopes[c] = dot(seen, film.dyes()[c]) / light;
    return out;
}

Triple amounts_of_grey(const Stock& film, double h) { return film.amounts({h, h, h}); }

// The dyes of the exposure whose density for the eye is that of the base plus `above_base`.
Triple visual_amounts(const Stock& film, const Curve& visual, double above_base) {
    const double wanted = reading_of(film, visual, film.min_amounts()).density + above_base;
    double light = film.log_exposures().front(), dark = film.log_exposures().back();
    if (film.material().positive()) std::swap(light, dark);
    for (int i = 0; i < 50; ++i) {
        const double middle = (light + dark) / 2;
        (reading_of(film, visual, amounts_of_grey(film, middle)).density < wanted ? light : dark) = middle;
    }
    return amounts_of_grey(film, light);
}

}  // namespace

Result<std::array<Table1, 3>> granularity(const Material& film, double pushed) {
    constexpr double kMax = 4.5, kStep = 0.05;
    std::array<Table1, 3> out;
    const auto fill = [&](std::size_t c, auto sigma) {
        out[c] = tabulated(0, kMax, kStep, [&](double density) { return push_contrast(pushed) * sigma(density) / 1000; });
    };
    if (!film.colour) {  // as the square root of the density above the base, [Nutting]; the sheet gives it at density 1
        if (film.rms == 0) return Error{ErrorCode::kUnsupported, film.title + ": its granularity is not known"};
        const Result<MonoCurve> curve = mono_film(film, 0);
        if (!curve) return curve.error();
        const double base = std::ranges::min(curve->density);
        for (std::size_t c = 0; c < 3; ++c)
            fill(c, [&](double density) { return film.rms * std::sqrt(std::max(density - base, 0.0)); });
        return out;
    }
    const Result<std::optional<Columns>> own = find_table(film, "grain");
    if (!own) return own.error();
    if (!*own && film.rms == 0) return Error{ErrorCode::kUnsupported, film.title + ": its granularity is not known"};
    const Result<Stock> stock = Stock::make(film);
    if (!stock) return stock.error();
    const Columns shape = *own ? **own : shape_for(film);
    const Columns shape_curves = common_table(film.positive() ? "kodak_ektachrome_100d.curves" : "kodak_5219.curves");
    const Triple base = stock->integral_density(stock->min_amounts());
    // The granularity of layer c at an amount of dye, in a grey: its squares add up, over all dyes, to those of the sheet.
    const auto plain = [&](std::size_t c, double amount) {
        const Triple grey = amounts_of_grey(*stock, stock->exposure_for(c, amount));
        std::array<Triple, 3> added{};
        Triple squares{};
        for (std::size_t i = 0; i < 3; ++i) {
            const Reading read = reading_of(*stock, stock->densitometer_weights()[i], grey);
            const double at = *own ? read.density : read.density - base[i] + std::ranges::min(shape_curves[kLayer[i]]);
            const double sigma = interpolated(at, shape.values[0], shape[kLayer[i]]);
            squares[i] = sigma * sigma;
            for (std::size_t j = 0; j < 3; ++j) added[i][j] = read.slopes[j] * read.slopes[j];
        }
        return std::sqrt(std::max(solve(added, squares)[c], 0.0));
    };
    double scale = 1;
    if (!*own) {  // what the eye sees of the three layers at density 1 above the base is the rms of the sheet
        const Curve visual = visual_densitometer();
        const Triple amounts = visual_amounts(*stock, visual, 1);
        const Reading read = reading_of(*stock, visual, amounts);
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double seen = read.slopes[c] * plain(c, amounts[c]);
            sum += seen * seen;
        }
        scale = film.rms / std::sqrt(sum);
    }
    for (std::size_t c = 0; c < 3; ++c) fill(c, [&](double amount) { return scale * plain(c, amount); });
    return out;
}

GrainField::GrainField(std::uint64_t seed, double pixel_um, int layers) : seed_(seed), pixel_um_(pixel_um), layers_(layers) {
    while (level_ < kFinest && kCoarsest / static_cast<double>(1 << level_) > pixel_um / 2) ++level_;
    cell_um_ = kCoarsest / static_cast<double>(1 << level_);
    strength_ = std::sqrt(variance(pixel_um) / variance(kAperture));
}

void GrainField::see(int begin, int pixels, Taps& taps) const {
    if (taps.begin == begin && taps.pixels == pixels) return;
    taps = {begin, pixels, static_cast<int>((pixel_um_ + 2 * kCloud) / cell_um_) + 2, {}, {}};
    for (int i = 0; i < pixels; ++i) {
        const double a = (begin + i) * pixel_um_, b = a + pixel_um_;
        const auto first = static_cast<std::int64_t>(std::floor((a - kCloud) / cell_um_));
        std::vector<double> seen;
        double squares = 0;
        for (int t = 0; t < taps.each; ++t) {
            const auto cell = static_cast<double>(first + t);
            seen.push_back(part(a, b, cell * cell_um_, (cell + 1) * cell_um_));
            squares += seen.back() * seen.back();
        }
        // The cells are not infinitely small, so what a pixel sees depends a little on where it lies between them: made up for.
        const double factor = strength_ / std::sqrt(squares);
        taps.first.push_back(first);
        for (const double s : seen) taps.weights.push_back(static_cast<float>(s * factor));
    }
}

// Haar refinement: four children are their parent plus independent details, and their mean is their parent. Values have variance 1:
// those of a level are twice as strong as their parents', in proportion to the reciprocal of their width. Fills `fine` with the
// cells that are wanted, and some around them: returns which.
GrainField::Cells GrainField::fill_cells(std::uint64_t layer, const Cells& wanted, Scratch& scratch) const {
    std::array<Cells, kFinest + 1> areas;
    areas[static_cast<std::size_t>(level_)] = wanted;
    for (int level = level_; level-- > 0;) {
        const Cells& below = areas[static_cast<std::size_t>(level) + 1];
        areas[static_cast<std::size_t>(level)] = {floor_half(below.x0), floor_half(below.y0), floor_half(below.x1),
                                                  floor_half(below.y1)};
    }
    Cells from = areas[0];
    scratch.fine.resize(from.width() * from.height());
    for (std::int64_t y = from.y0; y <= from.y1; ++y) {
        for (std::int64_t x = from.x0; x <= from.x1; ++x)
            scratch.fine[static_cast<std::size_t>(y - from.y0) * from.width() + static_cast<std::size_t>(x - from.x0)] =
                static_cast<float>(counts(key_of(seed_, layer, 0), x, y).n[0] - 8) * 0.5F;
    }
    for (int level = 0; level < level_; ++level) {
        const Cells& used = areas[static_cast<std::size_t>(level)];
        const Cells to{2 * used.x0, 2 * used.y0, 2 * used.x1 + 1, 2 * used.y1 + 1};  // all children
        const std::uint64_t key = key_of(seed_, layer, level + 1);
        std::swap(scratch.coarse, scratch.fine);
        scratch.fine.resize(to.width() * to.height());
        for (std::int64_t y = used.y0; y <= used.y1; ++y) {
            const float* parents =
                &scratch.coarse[static_cast<std::size_t>(y - from.y0) * from.width() + static_cast<std::size_t>(used.x0 - from.x0)];
            float* upper = &scratch.fine[static_cast<std::size_t>(2 * y - to.y0) * to.width()];
            float* lower = upper + to.width();
            for (std::int64_t x = used.x0; x <= used.x1; ++x) {
                // Children have variance 1: each is the sum of four independent halves.
                const auto [a, b, c, unused] = counts(key, x, y).n;
                const float half = 0.5F * parents[x - used.x0];
                std::int64_t i = 2 * (x - used.x0);
                upper[i] = half + 0.25F * static_cast<float>(a + b + c - 24);
                lower[i] = half + 0.25F * static_cast<float>(b - a - c + 8);
                ++i;
                upper[i] = half + 0.25F * static_cast<float>(a - b - c + 8);
                lower[i] = half + 0.25F * static_cast<float>(c - a - b + 8);
            }
        }
        from = to;
    }
    return from;
}

void GrainField::fill(int x0, int y0, int width, int height, const std::array<float*, 3>& planes, Scratch& scratch) const {
    see(x0, width, scratch.columns);
    see(y0, height, scratch.rows);
    const Taps &columns = scratch.columns, &rows = scratch.rows;
    const auto each = static_cast<std::size_t>(columns.each);
    const Cells wanted{columns.first.front(), rows.first.front(), columns.first.back() + columns.each - 1,
                       rows.first.back() + rows.each - 1};
    for (int layer = 0; layer < layers_; ++layer) {
        const Cells cells = fill_cells(static_cast<std::uint64_t>(layer), wanted, scratch);
        scratch.sums.resize(cells.width());
        float* out = planes[static_cast<std::size_t>(layer)];
        for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
            std::ranges::fill(scratch.sums, 0.0F);
            for (std::size_t i = 0; i < each; ++i) {
                const float weight = rows.weights[y * each + i];
                const float* row = &scratch.fine[(static_cast<std::size_t>(rows.first[y] - cells.y0) + i) * cells.width()];
                for (std::size_t x = 0; x < scratch.sums.size(); ++x) scratch.sums[x] += weight * row[x];
            }
            const float* weights = columns.weights.data();
            for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x, weights += each) {
                const float* seen = &scratch.sums[static_cast<std::size_t>(columns.first[x] - cells.x0)];
                float sum = 0;
                for (std::size_t i = 0; i < each; ++i) sum += weights[i] * seen[i];
                *out++ = sum;
            }
        }
    }
}

std::size_t GrainField::scratch_bytes(int width, int height) const {
    const auto along = [&](int n) { return static_cast<std::size_t>((n * pixel_um_ + 2 * kCloud) / cell_um_) + 6; };
    const std::size_t taps = static_cast<std::size_t>(width + height) * (sizeof(std::int64_t) + 4 * along(1));
    return 4 * (2 * along(width) * along(height) + along(width)) + 2 * taps;  // vectors may hold twice what they need
}

}  // namespace latent::film
