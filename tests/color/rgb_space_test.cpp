#include "color/rgb_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "color/adaptation.h"

namespace latent::color {
namespace {

using ::testing::HasSubstr;

TEST(RgbSpace, LuminanceRowsAreThoseOfTheStandards) {
    struct Known {
        const char* name;
        std::array<double, 3> row;
    };
    for (const Known& known : {Known{"srgb", {0.212639, 0.715169, 0.072192}},
                               {"display-p3", {0.228975, 0.691739, 0.079287}},
                               {"rec2020", {0.262700, 0.677998, 0.059302}},
                               {"adobe-rgb", {0.297345, 0.627364, 0.075291}}}) {
        SCOPED_TRACE(known.name);
        const RgbSpace space = *RgbSpace::parse(known.name);
        double sum = 0;
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(space.luminance_row[i], known.row[i], 5.1e-7);
            sum += space.luminance_row[i];
        }
        EXPECT_NEAR(sum, 1, 1e-15);
        EXPECT_TRUE(space.check_luminance_row());
    }
}

TEST(RgbSpace, WhiteAndPrimariesMapToThemselves) {
    for (const std::string& name : RgbSpace::names()) {
        SCOPED_TRACE(name);
        const RgbSpace space = *RgbSpace::parse(name);
        const Xyz white = xyz_from_chromaticity(space.primaries.white), red = xyz_from_chromaticity(space.primaries.red);
        for (const double v : space.rgb_from_xyz* std::array{white.x, white.y, white.z}) EXPECT_NEAR(v, 1, 1e-14);
        const auto rgb = space.rgb_from_xyz * std::array{red.x, red.y, red.z};
        EXPECT_NEAR(rgb[1] / rgb[0], 0, 1e-14);
        EXPECT_NEAR(rgb[2] / rgb[0], 0, 1e-14);
        const Matrix3 product = space.rgb_from_xyz * space.xyz_from_rgb;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) EXPECT_NEAR(product.m[i][j], i == j, 1e-14);
        }
    }
    // IEC 61966-2-1 prints the sRGB matrix with four decimals.
    const std::array<std::array<double, 3>, 3> standard{
        {{3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(RgbSpace::srgb().rgb_from_xyz.m[i][j], standard[i][j], 4.2e-4);
    }
}

TEST(RgbSpace, EightNumbersAreASpace) {
    const RgbSpace space = *RgbSpace::parse("0.64,0.33,0.30,0.60,0.15,0.06,0.3127,0.3290");
    EXPECT_EQ(space.rgb_from_xyz, RgbSpace::srgb().rgb_from_xyz);
    for (const char* text : {"", "srgb2", "1,2,3", "0.64,0.33,0.30,0.60,0.15,0.06,0.3127,x",
                             "0.64,0.33,0.30,0.60,0.15,0.06,0.3127,0.3290,1", "0.64 0.33 0.30 0.60 0.15 0.06 0.3127 0.3290"}) {
        EXPECT_EQ(RgbSpace::parse(text).error().code, ErrorCode::kUsage) << text;
    }
    EXPECT_THAT(RgbSpace::parse("x").error().message, HasSubstr("srgb, display-p3, rec2020, adobe-rgb, or 8 numbers"));
}

TEST(RgbSpace, DegenerateSpacesAreRefused) {
    EXPECT_THAT(RgbSpace::parse("0.1,0.1,0.2,0.2,0.3,0.3,0.2,0.2").error().message, HasSubstr("on a line"));
    EXPECT_THAT(RgbSpace::parse("0.64,0,0.30,0.60,0.15,0.06,0.3127,0.3290").error().message, HasSubstr("y = 0"));
    EXPECT_THAT(RgbSpace::parse("nan,0.3,0.30,0.60,0.15,0.06,0.3127,0.3290").error().message, HasSubstr("not an RGB space"));
    EXPECT_THAT(RgbSpace::parse("0.64,0.33,0.30,0.60,0.15,0.06,0.30,0.60").error().message,
                HasSubstr("does not use one of the primaries"));
    // ACES AP0: blue lies below the line of purples.
    const RgbSpace ap0 = *RgbSpace::parse("0.7347,0.2653,0,1,0.0001,-0.077,0.32168,0.33767");
    EXPECT_NEAR(ap0.luminance_row[2], -0.072133, 5e-7);
    EXPECT_THAT(ap0.check_luminance_row().error().message, HasSubstr("the blue primary has the negative luminance -0.072133"));
}

TEST(RgbSpace, MatrixOfAnyScaleIsTheSameSpace) {
    const RgbSpace& srgb = RgbSpace::srgb();
    const RgbSpace scaled = *RgbSpace::from_matrix("percent", srgb.rgb_from_xyz * 0.01, nullptr, Transfer::srgb());
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(scaled.luminance_row[i], srgb.luminance_row[i], 1e-14);
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(scaled.rgb_from_xyz.m[i][j], srgb.rgb_from_xyz.m[i][j], 1e-13);
    }
    EXPECT_NEAR(scaled.primaries.green.y, 0.60, 1e-14);
    EXPECT_NEAR(scaled.primaries.white.x, 0.3127, 1e-14);
}

TEST(RgbSpace, SingularMatrixNeedsItsLuminanceRow) {
    const Matrix3 grey{{{{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}}};
    EXPECT_THAT(RgbSpace::from_matrix("grey", grey, nullptr, Transfer::srgb()).error().message, HasSubstr("singular"));
    const std::array<double, 3> row{1, 2, 1};
    const RgbSpace space = *RgbSpace::from_matrix("grey", grey, &row, Transfer::srgb());
    EXPECT_EQ(space.luminance_row, (std::array<double, 3>{0.25, 0.5, 0.25}));
    const std::array<double, 3> none{1, -1, 0};
    EXPECT_FALSE(RgbSpace::from_matrix("grey", grey, &none, Transfer::srgb()));
    const Matrix3 nan{{{{std::nan(""), 1, 0}, {0, 1, 0}, {0, 1, 0}}}};
    EXPECT_FALSE(RgbSpace::from_matrix("nan", nan, nullptr, Transfer::srgb()));
}

TEST(Transfer, EncodeAndDecodeAreInverse) {
    for (const Transfer& t :
         {Transfer::linear(), Transfer::srgb(), Transfer::rec2020(), Transfer::gamma(563.0 / 256), Transfer::gamma(1.8)}) {
        EXPECT_EQ(t.encode(0), 0);
        EXPECT_NEAR(t.encode(1), 1, 1e-15);
        for (double x = -1.5; x <= 1.5; x += 1.0 / 4096) {
            EXPECT_NEAR(t.decode(t.encode(x)), x, 4e-15);
            EXPECT_EQ(t.encode(-x), -t.encode(x));
            EXPECT_LT(t.encode(x), t.encode(x + 1.0 / 4096));
        }
    }
}

TEST(Transfer, KnownValues) {
    EXPECT_NEAR(Transfer::srgb().encode(0.214041140482233), 0.5, 1e-12);
    EXPECT_NEAR(Transfer::srgb().encode(0.001), 0.01292, 1e-15);
    EXPECT_NEAR(Transfer::gamma(2).encode(0.25), 0.5, 1e-15);
    // sRGB's printed constants leave a step of 2.6e-8 at the joint; Rec.2020's full constants leave none.
    for (const auto& [t, step] : {std::pair{Transfer::srgb(), 3e-8}, {Transfer::rec2020(), 1e-12}}) {
        EXPECT_NEAR(t.slope * t.linear_below, t.encode(t.linear_below), step);
    }
}

TEST(Adaptation, WhiteGoesToWhiteAndKeepsItsLuminance) {
    const Chromaticity d65{0.3127, 0.3290}, d50{0.3457, 0.3585}, e{1.0 / 3, 1.0 / 3};
    for (const auto& [from, to] : {std::pair{d65, d50}, {d50, d65}, {e, d65}}) {
        const Xyz source = xyz_from_chromaticity(from), target = xyz_from_chromaticity(to);
        const auto adapted = *adaptation_matrix(from, to) * std::array{source.x, source.y, source.z};
        EXPECT_NEAR(adapted[0], target.x, 1e-14);
        EXPECT_NEAR(adapted[1], 1, 1e-14);
        EXPECT_NEAR(adapted[2], target.z, 1e-14);
    }
    EXPECT_EQ(*adaptation_matrix(d65, d65), Matrix3{});
    // The matrix D65 -> D50 as published with whites (0.95047, 1, 1.08883) and (0.96422, 1, 0.82521) [ICC].
    const Matrix3 icc = *adaptation_matrix(chromaticity({0.95047, 1, 1.08883}), chromaticity({0.96422, 1, 0.82521}));
    const std::array<std::array<double, 3>, 3> published{
        {{1.0478112, 0.0228866, -0.0501270}, {0.0295424, 0.9904844, -0.0170491}, {-0.0092345, 0.0150436, 0.7521316}}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(icc.m[i][j], published[i][j], 1e-6);
    }
}

// The equal-energy white excites the cones of CAT16 equally, so adapting from it has the responses to the other white as
// eigenvalues: their sum is the trace [Li17].
TEST(Adaptation, Cat16ScalesTheConesOfItsPaper) {
    const Chromaticity e{1.0 / 3, 1.0 / 3}, a{0.44758, 0.40745};
    const Xyz white = xyz_from_chromaticity(a);
    const Matrix3 matrix = *adaptation_matrix(e, a, Cones::kCat16);
    const double responses = (0.401288 - 0.250268 - 0.002079) * white.x + (0.650173 + 1.204414 + 0.048952) * white.y +
                             (-0.051461 + 0.045854 + 0.953127) * white.z;
    EXPECT_NEAR(matrix.m[0][0] + matrix.m[1][1] + matrix.m[2][2], responses, 1e-12);
    const auto adapted = matrix * std::array{1.0, 1.0, 1.0};
    EXPECT_NEAR(adapted[0], white.x, 1e-12);
    EXPECT_NEAR(adapted[1], 1, 1e-12);
    EXPECT_NEAR(adapted[2], white.z, 1e-12);
    EXPECT_EQ(cones_by_name("von-kries").error().code, ErrorCode::kUsage);
}

TEST(Adaptation, ImpossibleWhitesAreRefused) {
    const Chromaticity d65{0.3127, 0.3290};
    for (const Chromaticity bad : {Chromaticity{0.3, 0}, {0, 0.3}, {0.7, 0.4}, {std::nan(""), 0.3}, {0.02, 0.01}}) {
        EXPECT_EQ(adaptation_matrix(bad, d65).error().code, ErrorCode::kOutOfRange) << bad.x << ' ' << bad.y;
        EXPECT_FALSE(adaptation_matrix(d65, bad)) << bad.x << ' ' << bad.y;
    }
}

}  // namespace
}  // namespace latent::color
