#include "color/tone_curve.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "color/print.h"

namespace latent::color {
namespace {

constexpr const char* kCurves[] = {"film", "linear", "reinhard", "filmic", "density", "density:0.7,1,0.2", "density:3,0.1,0.1"};

TEST(ToneCurve, RisesFromBlackOverHalfTowardsWhite) {
    for (const char* name : kCurves) {
        for (const double contrast : {0.5, 1.0, 2.5}) {
            SCOPED_TRACE(::testing::Message() << name << ' ' << contrast);
            const ToneCurve curve = *ToneCurve::make(name, contrast, 0);
            EXPECT_EQ(curve(0), 0);
            EXPECT_EQ(curve(-1), 0);
            EXPECT_NEAR(curve(1), 0.5, 1e-9);
            EXPECT_NEAR(curve(1e30), 1, 1e-6);
            double before = 0;
            for (double octave = -30; octave < 60; octave += 1.0 / 16) {
                const double printed = curve(std::exp2(octave));
                EXPECT_GE(printed, before - 1e-13);
                EXPECT_LE(printed, 1);
                before = printed;
            }
            for (const double printed : {0.01, 0.3, 0.9}) EXPECT_NEAR(curve(curve.exposure_of(printed)), printed, 1e-12);
        }
    }
}

// Formulas of docs/color.md, by hand.
TEST(ToneCurve, IsWhatItsFormulaSays) {
    const auto at = [](const char* name, double t, double contrast = 1, double black = 0) {
        return (*ToneCurve::make(name, contrast, black))(t);
    };
    EXPECT_NEAR(at("film", 2), 0.75, 1e-15);
    EXPECT_NEAR(at("linear", 0.5), 0.25, 1e-15);
    EXPECT_EQ(at("linear", 3), 1);
    EXPECT_NEAR(at("reinhard", 3), 0.75, 1e-15);
    EXPECT_NEAR(at("filmic", 2), 0.71266 * (2.51 * 0.71266 + 0.03) / (0.71266 * (2.43 * 0.71266 + 0.59) + 0.14), 1e-5);
    EXPECT_NEAR(at("film", 2, 2), 1 - std::exp2(-4), 1e-15);
    EXPECT_NEAR(at("film", 2, 1, 0.05), 0.70 / 0.95, 1e-15);
    EXPECT_EQ(at("film", 0.01, 1, 0.05), 0);
}

// Between toe and shoulder, density is a straight line of slope gamma: a factor of 10^(1/gamma) in exposure is one in
// transmittance of 10.
TEST(ToneCurve, DensityHasAStraightPartOfSlopeGamma) {
    for (const double gamma : {0.8, 2.0}) {
        const ToneCurve curve = *ToneCurve::make(fmt::format("density:{},0.05,0.05", gamma), 1, 0);
        const double t = curve.exposure_of(0.02), further = t * std::pow(10, 0.5 / gamma);
        EXPECT_NEAR(std::log10(curve(further) / curve(t)), 0.5, 0.02) << gamma;
    }
}

TEST(ToneCurve, OthersAreRefused) {
    for (const char* bad : {"", "aces", "film:1", "density:", "density:1", "density:1,2", "density:0,1,1", "density:1,0,1",
                            "density:1,1,nan", "density:1,1,1,1"})
        EXPECT_EQ(ToneCurve::make(bad, 1, 0).error().code, ErrorCode::kUsage) << bad;
}

// Luminance is exact for every curve: colours in and out of gamut, in double and in rows.
TEST(ToneCurve, EveryCurveKeepsLuminanceExactly) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> chromaticity(0, 0.8), octave(-14, 10);
    const RgbSpace& srgb = RgbSpace::srgb();
    for (const char* name : kCurves) {
        for (const auto& [contrast, black] : {std::pair{1.0, 0.0}, {1.7, 0.0}, {1.0, 0.02}}) {
            SCOPED_TRACE(::testing::Message() << name << ' ' << contrast << ' ' << black);
            const ToneCurve curve = *ToneCurve::make(name, contrast, black);
            const Tone tone = curve.is_film() ? Tone::kFilm : Tone::kCurve;
            for (const Gamut gamut : {Gamut::kLuminance, Gamut::kGrey}) {
                const Print print = *Print::create(srgb, {.sigma = 1.3, .tone = tone, .gamut = gamut, .curve = curve});
                std::vector<float> x, y, z;
                for (int i = 0; i < 2000; ++i) {
                    const double cx = chromaticity(random), cy = 0.02 + chromaticity(random) * 0.98,
                                 light = std::exp2(octave(random));
                    x.push_back(static_cast<float>(cx / cy * light));
                    y.push_back(static_cast<float>(light));
                    z.push_back(static_cast<float>((1 - cx - cy) / cy * light));
                }
                std::vector<float> r(x.size()), g(x.size()), b(x.size());
                PrintReport report, row_report;
                print.row(x, y, z, r, g, b, row_report);
                const auto& m = srgb.luminance_row;
                for (std::size_t i = 0; i < x.size(); ++i) {
                    const double expected = curve(1.3 * static_cast<double>(y[i]));
                    const Rgb rgb = print.pixel({x[i], y[i], z[i]}, report);
                    EXPECT_NEAR(m[0] * rgb.r + m[1] * rgb.g + m[2] * rgb.b, expected, 1e-13);
                    const double row =
                        m[0] * static_cast<double>(r[i]) + m[1] * static_cast<double>(g[i]) + m[2] * static_cast<double>(b[i]);
                    EXPECT_NEAR(row, expected, 3e-6) << y[i];
                    for (const float v : {r[i], g[i], b[i]}) EXPECT_TRUE(v >= 0 && v <= 1);
                }
            }
        }
    }
}

}  // namespace
}  // namespace latent::color
