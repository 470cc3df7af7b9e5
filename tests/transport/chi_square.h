// tests/transport/chi_square.h: does `sample` draw what `pdf` says? Directions in cells of the sphere, counted and integrated.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "render/math/vec.h"

namespace latent::render::testing {

// Upper tail of the chi-square distribution by Wilson and Hilferty's cube-root normal approximation (error below 1e-3 from 10
// degrees of freedom on).
inline double chi_square_tail(double chi2, double degrees) {
    const double a = 2 / (9 * degrees);
    const double z = (std::cbrt(chi2 / degrees) - (1 - a)) / std::sqrt(a);
    return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

// Fails unless independent draws, or such as are more even, fall into cells as often as expected, at level 1e-4.
inline void expect_counts_follow(const std::vector<double>& counted, const std::vector<double>& expected) {
    double chi2 = 0;
    for (std::size_t i = 0; i < counted.size(); ++i) {
        ASSERT_GE(expected[i], 10);
        chi2 += (counted[i] - expected[i]) * (counted[i] - expected[i]) / expected[i];
    }
    EXPECT_GT(chi_square_tail(chi2, static_cast<double>(counted.size() - 1)), 1e-4) << "chi^2 = " << chi2;
}

struct DirectionTest {
    std::function<std::optional<Vec3f>(std::uint32_t n)> sample;  // nothing: absorbed
    std::function<double(const Vec3f&)> pdf_omega;
    std::uint32_t count = 100'000;
    int rows = 16, columns = 32;  // in z and phi
    int fine = 48;                // points of a cell's integral, in each direction
};

// Fails unless counts follow the integrals of the density at level 1e-4 per test, and the density integrates to at most 1.
inline void expect_directions_follow(const DirectionTest& t) {
    const int cells = t.rows * t.columns;
    std::vector<double> expected(static_cast<std::size_t>(cells), 0.0), counted(expected);
    double whole = 0;
    for (int r = 0; r < t.rows; ++r) {
        for (int c = 0; c < t.columns; ++c) {
            double sum = 0;
            for (int i = 0; i < t.fine; ++i) {
                for (int j = 0; j < t.fine; ++j) {
                    const double z = -1 + 2 * (r + (i + 0.5) / t.fine) / t.rows,
                                 phi = 2 * std::numbers::pi * (c + (j + 0.5) / t.fine) / t.columns;
                    const double s = std::sqrt(1 - z * z);
                    sum += t.pdf_omega(Vec3f(Vec3d{s * std::cos(phi), s * std::sin(phi), z}));
                }
            }
            expected[static_cast<std::size_t>(r * t.columns + c)] = sum * 4 * std::numbers::pi / cells / (t.fine * t.fine);
            whole += expected[static_cast<std::size_t>(r * t.columns + c)];
        }
    }
    EXPECT_LT(whole, 1.01);
    double absorbed = 0;
    for (std::uint32_t n = 0; n < t.count; ++n) {
        const std::optional<Vec3f> w = t.sample(n);
        if (!w) {
            ++absorbed;
            continue;
        }
        const int r = std::min(static_cast<int>((static_cast<double>(w->z) + 1) / 2 * t.rows), t.rows - 1);
        double phi = std::atan2(static_cast<double>(w->y), static_cast<double>(w->x)) / (2 * std::numbers::pi);
        if (phi < 0) phi += 1;
        ++counted[static_cast<std::size_t>(r * t.columns + std::min(static_cast<int>(phi * t.columns), t.columns - 1))];
    }
    // Cells are joined until at least 10 directions are expected.
    double chi2 = 0, e = 0, o = 0;
    int degrees = -1;
    const auto close = [&] {
        if (e <= 0) return;
        chi2 += (o - e) * (o - e) / e;
        ++degrees;
        e = o = 0;
    };
    for (std::size_t i = 0; i < expected.size(); ++i) {
        e += expected[i] * t.count;
        o += counted[i];
        if (e >= 10) close();
    }
    e += std::max(0.0, 1 - whole) * t.count;
    o += absorbed;
    if (e >= 10 || o > 0) close();
    ASSERT_GE(degrees, 3);
    EXPECT_GT(chi_square_tail(chi2, degrees), 1e-4) << "chi^2 = " << chi2 << " with " << degrees << " degrees of freedom";
}

}  // namespace latent::render::testing
