// Wavelengths are a stratified draw from their density, and the same bits everywhere.
#include "sampledb/data/wavelengths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/bytes.h"
#include "base/hash.h"

namespace latent::sampledb {
namespace {

using Knot = WavelengthDensity::Knot;
constexpr std::uint64_t kOne = std::uint64_t{1} << 48;

// Uniform over 360..830 nm with a line at 589 nm, 0.05 nm wide, that holds a quarter. All integers.
WavelengthDensity with_line() {
    std::vector<Knot> knots;
    for (std::uint32_t nm = 360; nm <= 830; ++nm) {
        const std::uint64_t below = kOne / 4 * 3 / 470 * (nm - 360) + (nm > 589 ? kOne / 4 : 0);
        knots.push_back({nm << 20, nm == 830 ? kOne : below});
        if (nm == 589) knots.push_back({(nm << 20) + (1u << 20) / 20, below + kOne / 4});
    }
    return *WavelengthDensity::from_knots(knots);
}

// Q(lambda), by the definition.
double cumulative(const WavelengthDensity& density, double lambda_nm) {
    const double lambda = lambda_nm * 0x1p20;
    for (std::size_t i = 1; i < density.knots().size(); ++i) {
        const Knot& a = density.knots()[i - 1];
        const Knot& b = density.knots()[i];
        if (lambda > b.lambda) continue;
        const double t = (lambda - a.lambda) / (static_cast<double>(b.lambda) - a.lambda);
        return (static_cast<double>(a.cumulative) + t * static_cast<double>(b.cumulative - a.cumulative)) * 0x1p-48;
    }
    return 1;
}

TEST(Wavelengths, AreTheInverseOfTheCumulative) {
    const WavelengthDensity density = with_line();
    for (const std::uint32_t xi : {0u, 1u, 0x40000000u, 0x9ABCDEF0u, 0xFFFFFFFFu}) {
        for (const std::uint32_t k : {1u, 4u, 28u, 1024u}) {
            std::vector<float> lambda(k);
            density.batch(xi, lambda);
            for (std::uint32_t i = 0; i < k; ++i) {
                EXPECT_EQ(lambda[i], density.wavelength(xi, i, k));
                const double wanted = (xi * 0x1p-32 + i) / k;
                // float32 near 589 nm has steps of 6e-5 nm, which the line's slope of 5 / nm makes 3e-4
                EXPECT_NEAR(cumulative(density, static_cast<double>(lambda[i])), wanted, 4e-4) << xi << " " << i << "/" << k;
                if (i > 0) {
                    EXPECT_LT(lambda[i - 1], lambda[i]);
                }
                EXPECT_GT(density.pdf_lambda(lambda[i]), 0);
            }
        }
    }
}

TEST(Wavelengths, DensityIsTheSlopeOfTheCumulative) {
    const WavelengthDensity density = with_line();
    double integral = 0;
    const double step = 1.0 / 256;
    for (double lambda = 360 + step / 2; lambda < 830; lambda += step) {
        integral += step * static_cast<double>(density.pdf_lambda(static_cast<float>(lambda)));
    }
    EXPECT_NEAR(integral, 1, 0.25 * step / 0.05);  // the line's edges fall between steps
    EXPECT_NEAR(static_cast<double>(density.pdf_lambda(589.02f)), 0.25 / 0.05, 1e-3);
    EXPECT_NEAR(static_cast<double>(density.pdf_lambda(400)), 0.75 / 470, 1e-8);
    EXPECT_EQ(density.pdf_lambda(359.99f), 0);
    EXPECT_EQ(density.pdf_lambda(830.01f), 0);
    EXPECT_EQ(density.pdf_lambda(std::nanf("")), 0);
    EXPECT_GT(density.pdf_lambda(830), 0);  // a wavelength may round up to the last knot
}

TEST(Wavelengths, AreTheSameBitsEverywhere) {
    const WavelengthDensity density = with_line();
    Bytes bytes;
    ByteWriter out(bytes);
    std::vector<float> lambda(28);
    for (std::uint32_t i = 0; i < 1000; ++i) {
        density.batch(i * 0x9E3779B9u, lambda);
        for (const float nm : lambda) out.put(nm);
    }
    EXPECT_EQ(to_hex(hash128(bytes)), "f9ad792202d18f9c19c446884a46aa33");
}

TEST(Wavelengths, ImpossibleDensitiesAreRefused) {
    const auto refused = [](std::vector<Knot> knots) { return !WavelengthDensity::from_knots(std::move(knots)); };
    const Knot first{360u << 20, 0}, last{830u << 20, kOne};
    EXPECT_FALSE(refused({first, last}));
    EXPECT_TRUE(refused({}));
    EXPECT_TRUE(refused({last}));
    EXPECT_TRUE(refused({first, {400u << 20, 0}, last}));
    EXPECT_TRUE(refused({first, {300u << 20, kOne / 2}, last}));
    EXPECT_TRUE(refused({first, {830u << 20, kOne - 1}}));
    EXPECT_TRUE(refused({{360u << 20, 1}, last}));
    EXPECT_TRUE(refused({first, {4095u << 20, kOne}}));
    std::vector<Knot> many;
    for (std::uint32_t i = 0; i < 4097; ++i) many.push_back({(360u << 20) + i, i == 4096 ? kOne : i});
    EXPECT_TRUE(refused(many));
}

}  // namespace
}  // namespace latent::sampledb
