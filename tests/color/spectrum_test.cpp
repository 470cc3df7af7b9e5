#include "color/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "color/named_spectra.h"
#include "color/observer.h"
#include "color/visible_density.h"

namespace latent::color {
namespace {

Spectrum values_at(std::vector<double> lambda_nm, std::vector<double> value, Outside outside = Outside::kZero) {
    return *Spectrum::from_samples(std::move(lambda_nm), std::move(value), outside);
}

TEST(Spectrum, IsLinearBetweenSamplesAndEndsAsItWasTold) {
    const Spectrum zero = values_at({400, 500, 600}, {1, 3, 2});
    EXPECT_EQ(zero(400), 1);
    EXPECT_EQ(zero(450), 2);
    EXPECT_EQ(zero(550), 2.5);
    EXPECT_EQ(zero(600), 2);
    EXPECT_EQ(zero(399.999), 0);
    EXPECT_EQ(zero(600.001), 0);
    const Spectrum clamped = values_at({400, 500, 600}, {1, 3, 2}, Outside::kClamped);
    EXPECT_EQ(clamped(100), 1);
    EXPECT_EQ(clamped(900), 2);
    EXPECT_EQ(Spectrum()(500), 0);
    EXPECT_EQ(Spectrum::constant(0.5)(12345), 0.5);
    const Spectrum square = Spectrum::from_function([](double nm) { return nm * nm; }, Outside::kZero);
    EXPECT_EQ(square(360), 360 * 360);
    EXPECT_EQ(square(829.5), (829 * 829 + 830 * 830) / 2.0);
    EXPECT_EQ(square(830.5), 0);
}

TEST(Spectrum, RefusesSamplesThatAreNoFunction) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(Spectrum::from_samples({}, {}, Outside::kZero));
    EXPECT_FALSE(Spectrum::from_samples({400, 500}, {1}, Outside::kZero));
    EXPECT_FALSE(Spectrum::from_samples({400, 400}, {1, 1}, Outside::kZero));
    EXPECT_FALSE(Spectrum::from_samples({500, 400}, {1, 1}, Outside::kZero));
    EXPECT_FALSE(Spectrum::from_samples({400, nan}, {1, 1}, Outside::kZero));
    EXPECT_FALSE(Spectrum::from_samples({400, 500}, {1, inf}, Outside::kZero));
    for (const double kelvin : {0.0, -1.0, nan, inf}) EXPECT_FALSE(Spectrum::blackbody(kelvin)) << kelvin;
}

// Between knots the product is a parabola; a fine midpoint sum (error ~ h^2) must approach the exact integral, jumps included.
TEST(Spectrum, IntegralOfProductIsExact) {
    EXPECT_DOUBLE_EQ(integral_of_product(Spectrum::constant(2), Spectrum::constant(3)), 6 * 470);
    EXPECT_DOUBLE_EQ(integral_of_product(values_at({400, 410}, {0, 1}), values_at({400, 410}, {0, 1})), 10.0 / 3);
    EXPECT_DOUBLE_EQ(integral_of_product(values_at({300, 365}, {1, 1}), Spectrum::constant(1)), 5);
    const Spectrum box = values_at({500.25, 600.75}, {2, 1}), saw = values_at({360, 512.5, 513, 830}, {0, 1, 0.25, 0.5});
    double sum = 0;
    constexpr int kSteps = 470'000;
    for (int i = 0; i < kSteps; ++i) {
        const double lambda = kLambdaMin + (i + 0.5) * 0.001;
        sum += box(lambda) * saw(lambda) * 0.001;
    }
    EXPECT_NEAR(integral_of_product(box, saw), sum, 1e-5);
}

TEST(Spectrum, IntegerNmSamplesAreItsValuesThere) {
    const IntegerNmSpectrum s = sampled_at_integer_nm(values_at({359.5, 590.25}, {0, 230.75}));
    for (int i = 0; i < kIntegerNmCount; ++i) EXPECT_EQ(s.value[i], i <= 230 ? static_cast<float>(i) + 0.5F : 0) << i;
}

TEST(Spectrum, BlackbodyPeaksWhereWienSaysAndHasThePublishedColour) {
    const Spectrum b = *Spectrum::blackbody(5000);  // peak 579.55 nm
    EXPECT_NEAR(b(579.55), 1, 1e-5);
    EXPECT_NEAR(b.max_value(), 1, 1e-5);
    // Ratio of Planck's law at 450 and 700 nm, worked by hand: (700/450)^5 (e^(c2/(700 T)) - 1) / (e^(c2/(450 T)) - 1).
    const double c2 = 1.438776877e7;
    EXPECT_NEAR(b(450) / b(700), std::pow(700.0 / 450, 5) * std::expm1(c2 / 700 / 5000) / std::expm1(c2 / 450 / 5000), 1e-12);
    // Illuminant A is the blackbody of 2855.5 K on today's scale: x = 0.44758, y = 0.40745 [CIE15].
    const Chromaticity a = chromaticity(xyz_from_spectrum(*Spectrum::blackbody(2848 * 1.438776877 / 1.435), Observer::cie1931()));
    EXPECT_NEAR(a.x, 0.44758, 2e-5);
    EXPECT_NEAR(a.y, 0.40745, 2e-5);
}

// pbrt's normaliser of lights for two lamps, worked out independently from the same tables.
TEST(Spectrum, PhotometricSumOfKnownLights) {
    EXPECT_NEAR(photometric_sum(Spectrum::constant(1)), 106.856917, 1e-6);
    EXPECT_NEAR(photometric_sum(*Spectrum::blackbody(2856)), 37.1556, 1e-4);
    EXPECT_NEAR(photometric_sum(values_at({360, 586.5, 588.5, 590.5, 592.5, 830}, {0, 0, 1, 1, 0, 0})), 3.05199, 1e-5);
}

TEST(VisibleDensity, IsTheSlopeOfItsCdf) {
    EXPECT_NEAR(visible_pdf_lambda(538), 0.0039398042, 1e-10);
    EXPECT_EQ(visible_cdf(360), 0);
    EXPECT_EQ(visible_cdf(830), 1);
    EXPECT_EQ(visible_pdf_lambda(359.9), 0);
    EXPECT_EQ(visible_pdf_lambda(std::numeric_limits<double>::quiet_NaN()), 0);
    for (double lambda = 361; lambda < 830; lambda += 7.3) {
        EXPECT_NEAR((visible_cdf(lambda + 1e-3) - visible_cdf(lambda - 1e-3)) / 2e-3, visible_pdf_lambda(lambda), 1e-10);
    }
}

}  // namespace
}  // namespace latent::color
