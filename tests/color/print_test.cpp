#include "color/print.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "color/adaptation.h"
#include "tests/color/simd_targets.h"

namespace latent::color {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kMax = std::numeric_limits<float>::max(), kTiny = std::numeric_limits<float>::denorm_min();

struct Planes {
    std::vector<float> a, b, c;
    explicit Planes(std::size_t n = 0) : a(n), b(n), c(n) {}
    void push(double x, double y, double z) {
        a.push_back(static_cast<float>(x));
        b.push_back(static_cast<float>(y));
        c.push_back(static_cast<float>(z));
    }
    std::size_t size() const { return a.size(); }
    Xyz at(std::size_t i) const { return {a[i], b[i], c[i]}; }
    bool operator==(const Planes&) const = default;
};

Planes print_rows(const Print& print, const Planes& in, PrintReport& report) {
    Planes out(in.size());
    print.row(in.a, in.b, in.c, out.a, out.b, out.c, report);
    return out;
}

Print make_print(const RgbSpace& space, double sigma, Gamut gamut, const Matrix3& adaptation = {}) {
    return *Print::create(space, {.sigma = sigma, .tone = Tone::kFilm, .gamut = gamut, .adaptation = adaptation});
}

// Colours in and out of every gamut: all chromaticities of [-0.2, 1.2]^2 with y > 0, luminances over 40 octaves.
Planes random_colours(std::size_t n, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> xy(-0.2, 1.2), octave(-20, 20);
    Planes out;
    while (out.size() < n) {
        const double x = xy(random), y = xy(random), luminance = std::exp2(octave(random));
        if (y > 1e-4) out.push(x / y * luminance, luminance, (1 - x - y) / y * luminance);
    }
    return out;
}

// A regular grid of real and unreal colours, the greys and the primaries among them.
Planes grid_of_colours() {
    Planes out;
    for (double y = 1.0 / 65536; y < 4096; y *= 4) {
        for (double x = -0.25; x <= 1; x += 0.0625) {
            for (double v = 0.0625; v <= 1; v += 0.0625) out.push(x / v * y, y, (1 - x - v) / v * y);
        }
        out.push(0.3127 / 0.3290 * y, y, 0.3583 / 0.3290 * y);
        for (const auto& [px, py] : {std::pair{0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}})
            out.push(px / py * y, y, (1 - px - py) / py * y);
    }
    return out;
}

struct Worst {
    double luminance_error = 0, below_zero = 0, above_one = 0;
    void look(double r, double g, double b, const RgbSpace& space, double y_printed) {
        const double luminance = space.luminance_row[0] * r + space.luminance_row[1] * g + space.luminance_row[2] * b;
        const double error = std::abs(luminance - y_printed);
        luminance_error = error <= luminance_error ? luminance_error : error;  // NaN comes through
        for (const double v : {r, g, b}) {
            below_zero = std::min(below_zero, v);
            above_one = std::max(above_one, v - 1);
        }
    }
};

class PrintLaws : public ::testing::TestWithParam<Gamut> {};

TEST_P(PrintLaws, EveryColourIsDisplayableAndKeepsItsPrintedLuminance) {
    const Matrix3 from_e = *adaptation_matrix({1.0 / 3, 1.0 / 3}, {0.3127, 0.3290});
    const Planes grid = grid_of_colours(), random = random_colours(1'000'000, 1);
    for (const std::string& name : RgbSpace::names()) {
        const RgbSpace space = *RgbSpace::parse(name);
        for (const Matrix3& adaptation : {Matrix3{}, from_e}) {
            for (const double sigma : {1e-3, 0.3, 1.0, 7.0, 1e4}) {
                SCOPED_TRACE(::testing::Message() << name << " sigma " << sigma << (adaptation == Matrix3{} ? "" : " adapted"));
                const Print print = make_print(space, sigma, GetParam(), adaptation);
                const Planes& in = name == "srgb" && sigma == 1.0 ? random : grid;
                PrintReport report, reference_report;
                const Planes out = print_rows(print, in, report);
                Worst row, reference;
                for (std::size_t i = 0; i < in.size(); ++i) {
                    const Xyz xyz = in.at(i);
                    const auto adapted = adaptation * std::array{xyz.x, xyz.y, xyz.z};
                    const double y_printed = adapted[1] > 0 ? -std::expm1(-sigma * adapted[1] * std::log(2.0)) : 0;
                    row.look(out.a[i], out.b[i], out.c[i], space, y_printed);
                    const Rgb rgb = print.pixel(xyz, reference_report);
                    reference.look(rgb.r, rgb.g, rgb.b, space, y_printed);
                }
                EXPECT_LT(row.luminance_error, 1e-6);
                EXPECT_EQ(row.below_zero, 0);
                EXPECT_EQ(row.above_one, 0);
                EXPECT_LT(reference.luminance_error, 1e-14);
                EXPECT_EQ(reference.below_zero, 0);
                EXPECT_EQ(reference.above_one, 0);
                EXPECT_EQ(report.pixels, in.size());
                EXPECT_EQ(report.negative, reference_report.negative);
                EXPECT_EQ(report.clipped, 0U);
            }
        }
    }
}

TEST_P(PrintLaws, RowsFollowTheReference) {
    // Where the gamut's border is met, the slope of the mapping is bounded by 1 / (1 - y'): stay off white to compare components.
    const Print print = make_print(RgbSpace::srgb(), 1, GetParam());
    Planes in;
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> xy(0.05, 0.7), octave(-10, 3);
    while (in.size() < 100'000) {
        const double x = xy(random), y = xy(random), luminance = std::exp2(octave(random));
        if (x + y < 1) in.push(x / y * luminance, luminance, (1 - x - y) / y * luminance);
    }
    PrintReport report, reference_report;
    const Planes out = print_rows(print, in, report);
    double worst = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
        const Rgb rgb = print.pixel(in.at(i), reference_report);
        worst = std::max({worst, std::abs(rgb.r - out.a[i]), std::abs(rgb.g - out.b[i]), std::abs(rgb.b - out.c[i])});
    }
    EXPECT_LT(worst, 2e-5);
    EXPECT_NEAR(static_cast<double>(report.out_of_gamut), static_cast<double>(reference_report.out_of_gamut), 10);
    EXPECT_GT(report.out_of_gamut, 1000U);
}

TEST_P(PrintLaws, EveryInstructionSetGivesTheSameBits) {
    Planes in = random_colours(10'001, 3);
    for (const float odd : {0.0F, -1.0F, kInf, -kInf, kNan, kMax, kTiny}) {
        for (const float y : {1.0F, 0.0F, -1.0F, kInf, kNan, kMax, kTiny}) {
            in.push(odd, y, 0.5);
            in.push(0.5, y, odd);
        }
    }
    for (int i = 0; i < 47; ++i) in.push(0, kMax, 0);  // adapted beyond kMax: white, but a number, whatever its neighbours are
    in.push(0, kNan, 0);
    const Matrix3 from_e = *adaptation_matrix({1.0 / 3, 1.0 / 3}, {0.3127, 0.3290});
    const ToneCurve curve = *ToneCurve::make("density", 1.3, 0.01);
    for (const Tone tone : {Tone::kFilm, Tone::kCurve, Tone::kNone}) {
        for (const Matrix3& adaptation : {Matrix3{}, from_e}) {
            const Print print = *Print::create(
                RgbSpace::srgb(),
                {.sigma = 1.7, .tone = tone, .gamut = GetParam(), .adaptation = adaptation, .curve = curve, .range = {0.1F, 2}});
            PrintReport first_report;
            const Planes first = print_rows(print, in, first_report);
            EXPECT_EQ(first_report.pixels, in.size());
            with_every_simd_target([&] {
                PrintReport report;
                EXPECT_EQ(print_rows(print, in, report), first);
                EXPECT_EQ(report, first_report);
            });
        }
    }
}

TEST_P(PrintLaws, RowsMayOverwriteTheirInputAndHaveAnyLength) {
    const Print print = make_print(RgbSpace::srgb(), 1, GetParam());
    for (std::size_t n = 0; n < 40; ++n) {
        const Planes in = random_colours(n, 4 + n);
        Planes here = in;
        PrintReport report;
        const Planes there = print_rows(print, in, report);
        print.row(here.a, here.b, here.c, here.a, here.b, here.c, report);
        EXPECT_EQ(here, there);
        EXPECT_EQ(report.pixels, 2 * n);
    }
}

TEST_P(PrintLaws, BrightnessIsMonotoneWhateverTheColour) {
    const Print print = make_print(RgbSpace::srgb(), 1, GetParam());
    const RgbSpace& space = RgbSpace::srgb();
    PrintReport report;
    for (double x = 0.05; x < 0.75; x += 0.05) {
        for (double y = 0.05; x + y < 1; y += 0.05) {
            double last = 0;
            for (double luminance = 1.0 / 256; luminance < 64; luminance *= 1.05) {
                const Rgb rgb = print.pixel({x / y * luminance, luminance, (1 - x - y) / y * luminance}, report);
                const double printed =
                    space.luminance_row[0] * rgb.r + space.luminance_row[1] * rgb.g + space.luminance_row[2] * rgb.b;
                EXPECT_GE(printed, last - 1e-15);
                last = printed;
            }
            EXPECT_GT(last, 1 - 1e-14);  // and every colour ends in white
        }
    }
}

TEST_P(PrintLaws, RowsOfAnyLengthCountWhatTheDisplayShowsBlackOrWhite) {
    const Matrix3 from_e = *adaptation_matrix({1.0 / 3, 1.0 / 3}, {0.3127, 0.3290});
    for (const Matrix3& adaptation : {Matrix3{}, from_e}) {
        const Print print =
            *Print::create(RgbSpace::srgb(), {.sigma = 1, .gamut = GetParam(), .adaptation = adaptation, .range = {0.1F, 2}});
        for (std::size_t n = 1; n < 40; ++n) {
            Planes in = random_colours(n, 40 + n);
            in.push(0, 0, 0);
            in.push(1, -1, 1);
            in.push(1, kNan, 1);
            PrintReport report, expected;
            Planes out = in;
            std::vector<float> luminances(in.size());
            print.row(in.a, in.b, in.c, out.a, out.b, out.c, report, luminances);
            std::uint64_t black = 0, burnt = 0;
            for (std::size_t i = 0; i < in.size(); ++i) {
                print.pixel(in.at(i), expected);
                black += luminances[i] < 0.1F;
                burnt += luminances[i] > 2;
            }
            EXPECT_EQ(report.black, black);
            EXPECT_EQ(report.burnt, burnt);
            EXPECT_EQ(expected.black, black);
            EXPECT_EQ(expected.burnt, burnt);
            EXPECT_GE(black, 1U);
            EXPECT_EQ(luminances[n], 0);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Operators, PrintLaws, ::testing::Values(Gamut::kLuminance, Gamut::kGrey),
                         [](const auto& operation) { return operation.param == Gamut::kLuminance ? "luminance" : "grey"; });

struct EdgeCase {
    float x, y, z;
    double expected;  // grey level; negative: any colour
    PrintReport report;
};

TEST(Print, EdgeCasesAreBlackWhiteOrGreyAndCounted) {
    const double half = 0.5;
    const EdgeCase cases[] = {
        {0, 0, 0, 0, {.pixels = 1}},
        {1, 0, 1, 0, {.pixels = 1}},
        {1, -0.0F, 1, 0, {.pixels = 1}},
        {1, -1, 1, 0, {.pixels = 1, .negative = 1}},
        {1, -kInf, 1, 0, {.pixels = 1, .negative = 1}},
        {1, kNan, 1, 0, {.pixels = 1, .nan = 1}},
        {kNan, kNan, kNan, 0, {.pixels = 1, .nan = 1}},
        {1, kInf, 1, 1, {.pixels = 1, .infinite = 1}},
        {kInf, kInf, kInf, 1, {.pixels = 1, .infinite = 1}},
        {kNan, kInf, 0, 1, {.pixels = 1, .infinite = 1}},
        {kNan, 1, 1, half, {.pixels = 1, .colourless = 1}},
        {1, 1, kInf, half, {.pixels = 1, .colourless = 1}},
        {-kInf, 1, kNan, half, {.pixels = 1, .colourless = 1}},
        {kNan, 0, 1, 0, {.pixels = 1}},
        {kMax, kMax, kMax, 1, {.pixels = 1, .out_of_gamut = 1}},
    };
    const Matrix3 from_e = *adaptation_matrix({1.0 / 3, 1.0 / 3}, {0.3127, 0.3290});
    for (const Gamut gamut : {Gamut::kLuminance, Gamut::kGrey}) {
        for (const Matrix3& adaptation : {Matrix3{}, from_e}) {
            const Print print = make_print(RgbSpace::srgb(), 1, gamut, adaptation);
            for (const EdgeCase& c : cases) {
                if (adaptation == from_e && std::isfinite(c.x + c.y + c.z)) continue;  // another luminance
                SCOPED_TRACE(::testing::Message() << c.x << ' ' << c.y << ' ' << c.z);
                PrintReport report, row_report;
                const Rgb rgb = print.pixel({c.x, c.y, c.z}, report);
                Planes in;
                in.push(c.x, c.y, c.z);
                const Planes out = print_rows(print, in, row_report);
                for (const double v : {rgb.r, rgb.g, rgb.b}) EXPECT_NEAR(v, c.expected, 1e-12);
                for (const float v : {out.a[0], out.b[0], out.c[0]}) EXPECT_NEAR(v, c.expected, 1e-6);
                if (c.y == kMax) continue;  // whether white counts as out of gamut is a matter of rounding
                EXPECT_EQ(report, c.report);
                EXPECT_EQ(row_report, c.report);
            }
        }
    }
}

TEST(Print, TinyAndHugeValuesKeepTheLaws) {
    const RgbSpace& space = RgbSpace::srgb();
    for (const Gamut gamut : {Gamut::kLuminance, Gamut::kGrey}) {
        for (const double sigma : {1e-20, 1.0, 1e20}) {
            const Print print = make_print(space, sigma, gamut);
            Planes in;
            for (const float y : {kTiny, 1e-38F, 1e-20F, 1.0F, 1e20F, kMax}) {
                for (const float x : {0.0F, kTiny, 1e-20F, 1.0F, 1e20F, kMax, -kTiny, -1.0F, -kMax}) {
                    in.push(x, y, 1);
                    in.push(1, y, x);
                    in.push(x, y, x);
                    in.push(x, y, -x);
                }
            }
            PrintReport report;
            const Planes out = print_rows(print, in, report);
            Worst worst;
            for (std::size_t i = 0; i < in.size(); ++i) {
                worst.look(out.a[i], out.b[i], out.c[i], space, -std::expm1(-sigma * in.b[i] * std::log(2.0)));
            }
            EXPECT_LT(worst.luminance_error, 1e-6);
            EXPECT_EQ(worst.below_zero, 0);
            EXPECT_EQ(worst.above_one, 0);
        }
    }
}

// With little light the print is linear: rgb = sigma ln 2 M (x, y, z), to the relative precision of float.
TEST(Print, SmallLuminancesKeepTheirRelativePrecision) {
    const Print print = make_print(RgbSpace::srgb(), 1, Gamut::kLuminance);
    for (const float y : {1e-3F, 1e-6F, 1e-12F, 1e-30F}) {
        Planes in;
        in.push(0.9 * y, y, 0.8 * y);
        PrintReport report;
        const Planes out = print_rows(print, in, report);
        const Rgb expected = print.pixel(in.at(0), report);
        EXPECT_NEAR(out.a[0] / expected.r, 1, 2e-6);
        EXPECT_NEAR(out.c[0] / expected.b, 1, 2e-6);
        const auto linear = RgbSpace::srgb().rgb_from_xyz * std::array<double, 3>{in.a[0], in.b[0], in.c[0]};
        EXPECT_NEAR(expected.r / (linear[0] * std::log(2.0)), 1, 0.4 * y + 1e-12);
    }
}

TEST(Print, HalfIsReachedAtOneOverSigmaAndStopsDouble) {
    PrintReport report;
    const Chromaticity d65 = RgbSpace::srgb().primaries.white;
    const Xyz white = xyz_from_chromaticity(d65);
    for (const double sigma : {0.01, 1.0, 40.0}) {
        const Rgb grey =
            make_print(RgbSpace::srgb(), sigma, Gamut::kGrey).pixel({white.x / sigma, 1 / sigma, white.z / sigma}, report);
        EXPECT_NEAR(grey.r, 0.5, 1e-14);
        EXPECT_NEAR(grey.g, 0.5, 1e-14);
    }
    EXPECT_EQ(pushed_sigma(0.75, 2), 3);
    EXPECT_EQ(pushed_sigma(3, -1), 1.5);
}

TEST(Print, ColoursInsideTheGamutOnlyChangeTheirBrightness) {
    const Print luminance = make_print(RgbSpace::srgb(), 1, Gamut::kLuminance),
                grey = make_print(RgbSpace::srgb(), 1, Gamut::kGrey);
    PrintReport report;
    const auto xyz = RgbSpace::srgb().xyz_from_rgb * std::array{0.5, 0.25, 0.125};
    const double y = xyz[1], factor = -std::expm1(-y * std::log(2.0)) / y;
    for (const Print& print : {luminance, grey}) {
        const Rgb rgb = print.pixel({xyz[0], xyz[1], xyz[2]}, report);
        EXPECT_NEAR(rgb.r, 0.5 * factor, 1e-14);
        EXPECT_NEAR(rgb.g, 0.25 * factor, 1e-14);
        EXPECT_NEAR(rgb.b, 0.125 * factor, 1e-14);
    }
    EXPECT_EQ(report.out_of_gamut, 0U);
}

TEST(Print, GreyOperatorMovesAlongTheLineToGrey) {
    const Print print = make_print(RgbSpace::srgb(), 1, Gamut::kGrey);
    PrintReport report;
    const Xyz laser{0.05, 0.5, 0.02};  // a green outside sRGB
    const Rgb rgb = print.pixel(laser, report);
    const double y = -std::expm1(-0.5 * std::log(2.0)), scale = y / 0.5;
    const auto unmapped = RgbSpace::srgb().rgb_from_xyz * std::array{laser.x * scale, laser.y * scale, laser.z * scale};
    const double t = (rgb.g - y) / (unmapped[1] - y);
    EXPECT_NEAR(rgb.r - y, t * (unmapped[0] - y), 1e-14);
    EXPECT_NEAR(rgb.b - y, t * (unmapped[2] - y), 1e-14);
    EXPECT_NEAR(std::min({rgb.r, rgb.g, rgb.b, 1 - rgb.r, 1 - rgb.g, 1 - rgb.b}), 0, 1e-15);  // it stops at the border
    EXPECT_EQ(report.out_of_gamut, 1U);
}

// Hue angle in OKLab [Ottosson20] of linear sRGB, and its chroma.
struct OklabHue {
    double degrees, chroma;
};
OklabHue oklab_hue(Rgb c) {
    const double l = std::cbrt(0.4122214708 * c.r + 0.5363325363 * c.g + 0.0514459929 * c.b);
    const double m = std::cbrt(0.2119034982 * c.r + 0.6806995451 * c.g + 0.1073969566 * c.b);
    const double s = std::cbrt(0.0883024619 * c.r + 0.2817188376 * c.g + 0.6299787005 * c.b);
    const double a = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
                 b = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
    return {std::atan2(b, a) * 180 / std::numbers::pi, std::hypot(a, b)};
}

// Exposure ramps of 16 stops on 144 chromaticities inside sRGB: the straight line to grey shifts hue less than clamping does, at a
// little less chroma. The figures are those of docs/color.md.
TEST(Print, GreyOperatorShiftsHueLessThanClamping) {
    const auto hue_and_chroma = [](Gamut gamut) {
        const Print print = make_print(RgbSpace::srgb(), 1, gamut);
        PrintReport report;
        std::vector<double> shift;
        double chroma = 0;
        for (int i = 0; i < 144; ++i) {
            const double angle = i % 36 * 10 * std::numbers::pi / 180,
                         radius = (i / 36 + 1) / 4.0;  // around white, out to the border
            Rgb c{1 + std::cos(angle), 1 + std::cos(angle - 2.0944), 1 + std::cos(angle + 2.0944)};
            const double low = std::min({c.r, c.g, c.b});
            c = {1 + radius * (c.r - low - 1), 1 + radius * (c.g - low - 1), 1 + radius * (c.b - low - 1)};
            const auto xyz = RgbSpace::srgb().xyz_from_rgb * std::array{c.r, c.g, c.b};
            for (double stops = -8; stops <= 8; stops += 1.0 / 16) {
                const double scale = std::exp2(stops) / xyz[1];
                const Rgb printed = print.pixel({xyz[0] * scale, xyz[1] * scale, xyz[2] * scale}, report);
                const OklabHue before = oklab_hue(c), after = oklab_hue(printed);
                chroma += after.chroma;
                if (after.chroma > 0.005) shift.push_back(std::abs(std::remainder(after.degrees - before.degrees, 360)));
            }
        }
        std::ranges::sort(shift);
        return std::pair{shift[shift.size() * 95 / 100], chroma / (144 * 257)};
    };
    const auto [clamp_shift, clamp_chroma] = hue_and_chroma(Gamut::kLuminance);
    const auto [grey_shift, grey_chroma] = hue_and_chroma(Gamut::kGrey);
    EXPECT_NEAR(clamp_shift, 18, 1);
    EXPECT_NEAR(grey_shift, 2.7, 0.2);
    EXPECT_NEAR(grey_chroma / clamp_chroma, 0.97, 0.01);
}

TEST(Print, ClipCountsWhatItCuts) {
    const Print print = make_print(RgbSpace::srgb(), 1, Gamut::kClip);
    Planes in;
    in.push(0.05, 0.5, 0.02);
    in.push(0.4, 0.4, 0.4);
    PrintReport report, reference_report;
    const Planes out = print_rows(print, in, report);
    for (std::size_t i = 0; i < in.size(); ++i) print.pixel(in.at(i), reference_report);
    EXPECT_EQ(report, (PrintReport{.pixels = 2, .out_of_gamut = 1, .clipped = 1}));
    EXPECT_EQ(report, reference_report);
    EXPECT_EQ(out.a[0], 0);
}

TEST(Print, ToneNoneOnlyConverts) {
    const Print print = *Print::create(RgbSpace::srgb(), {.sigma = 2, .tone = Tone::kNone});
    Planes in;
    for (const auto& [x, y, z] : {std::array{3.0, 2.0, 1.0}, {0.1, -0.2, 0.3}, {100.0, 1.0, 0.0}, {0.0, 0.0, 0.0}})
        in.push(x, y, z);
    PrintReport report, reference_report;
    const Planes out = print_rows(print, in, report);
    for (std::size_t i = 0; i < in.size(); ++i) {
        const Xyz xyz = in.at(i);
        const auto expected = RgbSpace::srgb().rgb_from_xyz * std::array{2 * xyz.x, 2 * xyz.y, 2 * xyz.z};
        const Rgb rgb = print.pixel(xyz, reference_report);
        EXPECT_NEAR(rgb.r, expected[0], 1e-13);
        EXPECT_NEAR(out.a[i], expected[0], 1e-6 * (1 + std::abs(expected[0])));
        EXPECT_NEAR(out.b[i], expected[1], 1e-6 * (1 + std::abs(expected[0])));
    }
    EXPECT_EQ(report, (PrintReport{.pixels = 4, .out_of_gamut = 3}));
    EXPECT_EQ(report, reference_report);
}

TEST(Print, ImpossibleSettingsAreRefused) {
    const RgbSpace& srgb = RgbSpace::srgb();
    for (const double sigma : {0.0, -1.0, std::nan(""), 1e300, double{kInf}})
        EXPECT_FALSE(Print::create(srgb, {.sigma = sigma})) << sigma;
    const RgbSpace ap0 = *RgbSpace::parse("0.7347,0.2653,0,1,0.0001,-0.077,0.32168,0.33767");
    EXPECT_THAT(Print::create(ap0, {.gamut = Gamut::kLuminance}).error().message, ::testing::HasSubstr("blue primary"));
    EXPECT_THAT(Print::create(ap0, {.gamut = Gamut::kGrey}).error().message, ::testing::HasSubstr("blue primary"));
    EXPECT_TRUE(Print::create(ap0, {.gamut = Gamut::kClip}));
    EXPECT_TRUE(Print::create(ap0, {.tone = Tone::kNone}));
    EXPECT_EQ(*gamut_by_name("grey"), Gamut::kGrey);
    EXPECT_FALSE(gamut_by_name("gray"));
}

TEST(Print, SingularMatrixPrintsWithAGivenLuminanceRow) {
    const Matrix3 grey{{{{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}}};  // a display that only knows greys
    const std::array<double, 3> row{0.2, 0.7, 0.1};
    const RgbSpace space = *RgbSpace::from_matrix("grey", grey, &row, Transfer::srgb());
    PrintReport report;
    for (const Gamut gamut : {Gamut::kLuminance, Gamut::kGrey}) {
        const Rgb rgb = make_print(space, 1, gamut).pixel({5, 1, 0.1}, report);
        for (const double v : {rgb.r, rgb.g, rgb.b}) EXPECT_NEAR(v, 0.5, 1e-15);
    }
}

}  // namespace
}  // namespace latent::color
