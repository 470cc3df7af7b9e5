#include "color/auto_exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace latent::color {
namespace {

std::vector<float> log_normal(std::size_t n, double mean_log2, double sd) {
    std::mt19937 random(1);
    std::normal_distribution<double> stops(mean_log2, sd);
    std::vector<float> y(n);
    for (float& v : y) v = static_cast<float>(std::exp2(stops(random)));
    return y;
}

// A bin is at most 1/64 octave wide on the logarithmic axis, 1.6 %.
TEST(LuminanceHistogram, LogAverageIsThatOfTheValuesBetweenThePercentiles) {
    LuminanceHistogram h;
    std::vector<float> y;
    double sum = 0;
    for (int i = 1; i <= 1000; ++i) {
        y.push_back(static_cast<float>(i));
        if (i > 100 && i <= 900) sum += std::log(i);
    }
    h.add(y);
    EXPECT_EQ(h.count(), 1000U);
    EXPECT_NEAR(h.log_average(0.1, 0.9) / std::exp(sum / 800), 1, 0.016);
    EXPECT_NEAR(h.log_average(0.9999, 1) / 1000, 1, 0.016);
    EXPECT_EQ(LuminanceHistogram().log_average(0, 1), 0);
}

TEST(LuminanceHistogram, OnlyPositiveFiniteValuesCount) {
    LuminanceHistogram h;
    const float inf = std::numeric_limits<float>::infinity();
    h.add(std::vector<float>{0, -0.0F, -1, inf, -inf, std::nanf(""), 1, std::numeric_limits<float>::max(),
                             std::numeric_limits<float>::denorm_min()});
    EXPECT_EQ(h.count(), 3U);
    EXPECT_EQ(h.dark(), 3U);
    EXPECT_NEAR(h.log_average(0.9, 1) / std::numeric_limits<float>::max(), 1, 0.016);
}

// A bin's centre is within half a bin of all its values: 1/128.
TEST(LuminanceHistogram, PercentilesAreThoseOfTheSortedValues) {
    std::vector<float> y = log_normal(10'000, -2, 4);
    LuminanceHistogram h;
    h.add(y);
    std::ranges::sort(y);
    for (const std::uint64_t dark : {0, 2500}) {
        h.add(std::vector<float>(dark / 2, 0.0F));
        h.add(std::vector<float>(dark / 2, -1.0F));
        for (const double p : {0.0001, 0.01, 0.1, 0.21, 0.3, 0.5, 0.9, 0.99, 1.0}) {
            const double rank = std::ceil(p * static_cast<double>(y.size() + dark)) - static_cast<double>(dark);
            const double exact = rank < 1 ? 0 : static_cast<double>(y[static_cast<std::size_t>(rank) - 1]);
            EXPECT_NEAR(h.percentile(p), exact, exact / 128) << p << " " << dark;
        }
    }
    EXPECT_EQ(h.percentile(0.2), 0);
    EXPECT_EQ(LuminanceHistogram().percentile(0.5), 0);
    LuminanceHistogram without_light;
    without_light.add(std::vector<float>(10, 0.0F));
    EXPECT_EQ(without_light.percentile(0.5), 0);
}

TEST(LuminanceHistogram, SumsDoNotDependOnTheirOrder) {
    const std::vector<float> y = log_normal(10'000, 0, 3);
    LuminanceHistogram whole, a, b;
    whole.add(y);
    a.add(std::span(y).subspan(0, 1234));
    b.add(std::span(y).subspan(1234));
    b += a;
    EXPECT_EQ(b.log_average(0.01, 0.99), whole.log_average(0.01, 0.99));
    EXPECT_EQ(b.percentile(0.5), whole.percentile(0.5));
}

TEST(AutoExposure, PrintsTheLogAverageAtMiddleGrey) {
    LuminanceHistogram h;
    h.add(log_normal(200'000, -3, 2));  // trimming is symmetric, so the average stays 2^-3
    const double sigma = *auto_sigma(h);
    EXPECT_NEAR(1 - std::exp2(-sigma / 8), 0.18, 0.003);
    EXPECT_EQ(sigma, std::round(sigma * 1000) / 1000);  // four digits
}

TEST(AutoExposure, FollowsTheLightAndIgnoresAFewLamps) {
    std::vector<float> y = log_normal(100'000, 0, 1);
    LuminanceHistogram dim, bright, lamps;
    dim.add(y);
    for (float& v : y) v *= 1024;
    bright.add(y);
    EXPECT_NEAR(*auto_sigma(dim) / *auto_sigma(bright), 1024, 1);
    lamps.add(std::vector<float>(500, 1e30F));
    lamps += dim;
    EXPECT_NEAR(*auto_sigma(lamps) / *auto_sigma(dim), 1, 0.02);
}

// A few lit things in the dark, where some light strays.
TEST(AutoExposure, IgnoresWhatIsBlackInAnyPrint) {
    const std::vector<float> lit = log_normal(20'000, 0, 1);
    LuminanceHistogram things, in_the_dark;
    things.add(lit);
    in_the_dark.add(lit);
    in_the_dark.add(log_normal(80'000, -20, 2));
    EXPECT_NEAR(*auto_sigma(in_the_dark) / *auto_sigma(things), 1.078, 0.02);  // of the lit, the brightest 5 % are trimmed
}

TEST(AutoExposure, NeedsLight) {
    LuminanceHistogram h;
    EXPECT_FALSE(auto_sigma(h));
    h.add(std::vector<float>{0, -1, std::nanf("")});
    EXPECT_EQ(auto_sigma(h).error().code, ErrorCode::kOutOfRange);
}

}  // namespace
}  // namespace latent::color
