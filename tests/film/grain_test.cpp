#include "color/film/grain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "color/film/mono.h"
#include "color/film/spectra.h"
#include "color/film/stock.h"
#include "color/power_of_ten.h"

namespace latent::film {
namespace {

std::vector<float> grain(const GrainField& field, int x0, int y0, int width, int height, std::size_t layer = 0) {
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::array<std::vector<float>, 3> planes{std::vector<float>(pixels), std::vector<float>(pixels), std::vector<float>(pixels)};
    GrainField::Scratch scratch;
    field.fill(x0, y0, width, height, {planes[0].data(), planes[1].data(), planes[2].data()}, scratch);
    return planes[layer];
}

double correlation(const std::vector<float>& a, const std::vector<float>& b) {
    double aa = 0, ab = 0, bb = 0, ma = 0, mb = 0;
    for (std::size_t i = 0; i < a.size(); ++i) ma += a[i], mb += b[i];
    ma /= static_cast<double>(a.size()), mb /= static_cast<double>(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double x = a[i] - ma, y = b[i] - mb;
        aa += x * x, ab += x * y, bb += y * y;
    }
    return ab / std::sqrt(aa * bb);
}

// Means over `factor` x `factor` pixels.
std::vector<float> averaged(const std::vector<float>& in, int width, int factor) {
    const int small = width / factor, rows = static_cast<int>(in.size()) / width / factor;
    std::vector<float> out(static_cast<std::size_t>(small * rows));
    for (int y = 0; y < rows * factor; ++y) {
        for (int x = 0; x < small * factor; ++x)
            out[static_cast<std::size_t>(y / factor * small + x / factor)] +=
                in[static_cast<std::size_t>(y * width + x)] / static_cast<float>(factor * factor);
    }
    return out;
}

// An aperture of 48 um, moved over fine pixels: the standard deviation of what it sees, in units of the granularity. With 4000
// places that do not overlap, the standard error is 1.1 %; four of these are allowed.
TEST(Grain, ThroughAnApertureOf48MicrometresIsAsStrongAsTheDataSheetSays) {
    for (const double pixel_um : {3.0, 4.4, 8.0}) {
        SCOPED_TRACE(pixel_um);
        const GrainField field(1, pixel_um, 1);
        const int step = static_cast<int>(std::ceil(60 / pixel_um)), across = 64, width = step * across;
        const std::vector<float> n = grain(field, 1000, 500, width, width);
        double sum = 0, squares = 0;
        for (int j = 0; j < across; ++j) {
            for (int i = 0; i < across; ++i) {
                double seen = 0, area = 0;
                for (int y = 0; y < step; ++y) {
                    for (int x = 0; x < step; ++x) {
                        // Parts of pixels at the rim, by 4 x 4 points.
                        double part = 0;
                        for (int s = 0; s < 16; ++s) {
                            const double px = (x + (s % 4 + 0.5) / 4 - step / 2.0) * pixel_um,
                                         py = (y + (s / 4 + 0.5) / 4 - step / 2.0) * pixel_um;
                            part += px * px + py * py < 24 * 24 ? 1.0 / 16 : 0;
                        }
                        area += part;
                        seen += part * n[static_cast<std::size_t>((j * step + y) * width + i * step + x)];
                    }
                }
                sum += seen / area;
                squares += seen / area * seen / area;
            }
        }
        const double count = across * across;
        EXPECT_NEAR(std::sqrt(squares / count - sum * sum / count / count), 1, 0.05);
    }
}

TEST(Grain, IsTheSameInEveryCrop) {
    for (const double pixel_um : {1.1, 4.4, 18.0, 61.0}) {
        const GrainField field(7, pixel_um, 3);
        const std::vector<float> whole = grain(field, 0, 0, 60, 40, 2), part = grain(field, 13, 7, 31, 22, 2);
        for (int y = 0; y < 22; ++y) {
            for (int x = 0; x < 31; ++x)
                ASSERT_EQ(part[static_cast<std::size_t>(y * 31 + x)], whole[static_cast<std::size_t>((y + 7) * 60 + x + 13)]);
        }
    }
}

// The same frame of 36 mm at 2000 and at 8000 pixels.
TEST(Grain, IsTheSameFilmAtEverySize) {
    const std::vector<float> small = grain(GrainField(3, 18, 1), 100, 60, 128, 128);
    const std::vector<float> large = averaged(grain(GrainField(3, 4.5, 1), 400, 240, 512, 512), 512, 4);
    EXPECT_GT(correlation(small, large), 0.9);
    EXPECT_GT(correlation(averaged(small, 128, 4), averaged(large, 128, 4)), 0.98);
    EXPECT_LT(std::abs(correlation(small, grain(GrainField(4, 18, 1), 100, 60, 128, 128))), 0.04);  // another seed
}

TEST(Grain, OfTheLayersIsIndependent) {
    const GrainField field(1, 6, 3);
    const std::vector<float> red = grain(field, 0, 0, 128, 128, 0), green = grain(field, 0, 0, 128, 128, 1);
    EXPECT_LT(std::abs(correlation(red, green)), 0.04);  // 4 of its standard errors, 1/128 at least
    EXPECT_LT(std::abs(correlation(green, grain(field, 0, 0, 128, 128, 2))), 0.04);
}

// No column is noisier than another: pixels of no simple size lie differently between the cells.
TEST(Grain, IsAsStrongEverywhere) {
    for (const double pixel_um : {4.39, 5.7, 9.1}) {
        SCOPED_TRACE(pixel_um);
        const int width = 64, height = 1024;
        const std::vector<float> n = grain(GrainField(1, pixel_um, 1), 0, 0, width, height);
        std::vector<double> squares(width);
        for (std::size_t i = 0; i < n.size(); ++i) squares[i % width] += n[i] * n[i] / height;
        const double mean = std::accumulate(squares.begin(), squares.end(), 0.0) / width;
        for (const double s : squares)
            EXPECT_NEAR(s / mean, 1, 0.35);  // neighbours are not independent: some 500 numbers, 5 errors
    }
}

// Standard deviation of a density when the amounts of dye of a grey have theirs.
double spread(const std::function<double(const Triple&)>& density, const Triple& grey, const std::array<Table1, 3>& sigma) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const Table1& table = sigma[c];
        const double at = std::clamp((grey[c] - static_cast<double>(table.first)) * static_cast<double>(table.per_unit), 0.0,
                                     static_cast<double>(table.y.size()) - 1.001);
        const auto below = static_cast<std::size_t>(at);
        const double s = std::lerp(static_cast<double>(table.y[below]), static_cast<double>(table.y[below + 1]),
                                   at - static_cast<double>(below));
        constexpr double kStep = 0.01;
        Triple more = grey, less = grey;
        more[c] += kStep, less[c] -= kStep;
        const double seen = s * (density(more) - density(less)) / (2 * kStep);
        sum += seen * seen;
    }
    return std::sqrt(sum);
}

// The grey with this density.
Triple grey_of(const Stock& film, const std::function<double(const Triple&)>& density, double wanted) {
    Triple best{};
    double off = 1e9;
    for (double h = film.log_exposures().front(); h < film.log_exposures().back(); h += 0.001) {
        const Triple grey = film.amounts({h, h, h});
        if (const double d = std::abs(density(grey) - wanted); d < off) off = d, best = grey;
    }
    EXPECT_LT(off, 0.01);
    return best;
}

// One number: visual, 1 above the base. Numbers by layer: of the densitometer of each, which also sees a little of the others.
TEST(Grain, OfEveryFilmIsWhatDensitometersReadAtDensityOne) {
    for (const Material& film : materials()) {
        if (!film.in_camera()) continue;
        SCOPED_TRACE(film.name);
        const auto sigma = granularity(film, 0);
        const auto own = find_table(film, "grain");
        ASSERT_TRUE(own);
        if (film.rms == 0 && !*own) {
            EXPECT_FALSE(sigma);
            continue;
        }
        ASSERT_TRUE(sigma) << sigma.error().message;
        for (const Table1& layer : *sigma) {
            for (const float s : layer.y) EXPECT_TRUE(s >= 0 && s < 0.2F);
        }
        if (!film.colour) {
            const MonoCurve curve = *mono_film(film, 0);
            const Triple one{std::ranges::min(curve.density) + 1, 0, 0};
            EXPECT_NEAR(spread([](const Triple& density) { return density[0]; }, one, *sigma) * 1000 / film.rms, 1, 0.01);
            continue;
        }
        const Stock stock = *Stock::make(film);
        if (!*own) {
            const Curve eye = visual_densitometer();
            const auto visual = [&](const Triple& a) { return -color::log10_of(dot(transmittance(stock.density(a)), eye)); };
            const Triple one = grey_of(stock, visual, visual(stock.min_amounts()) + 1);
            EXPECT_NEAR(spread(visual, one, *sigma) * 1000 / film.rms, 1, 0.01);
            continue;
        }
        for (std::size_t c = 0; c < 3; ++c) {
            const auto status = [&](const Triple& a) { return stock.integral_density(a)[c]; };
            const double density = std::max(1.0, status(stock.min_amounts()) + 0.3);
            const double sheet = interpolated(density, (**own).values[0], (**own)[c == 0 ? "r" : c == 1 ? "g" : "b"]);
            EXPECT_NEAR(spread(status, grey_of(stock, status, density), *sigma) * 1000 / sheet, 1, 0.05) << c;
        }
    }
}

}  // namespace
}  // namespace latent::film
