// What prints neutral: the white that was asked for, whatever names it, and its luminance stays.
#include "tools/convert/white.h"

#include <fmt/format.h>

#include <cmath>

#include "color/adaptation.h"
#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

using color::Chromaticity;
using image::Decoded;

Chromaticity named(const std::string& text) { return std::get<Chromaticity>(*parse_white(text)); }

// Values as published [CIE15], [WyszeckiStiles00]; 2856 K is what illuminant A imitates.
TEST(White, NamesAndTemperaturesHaveThePublishedChromaticities) {
    const struct {
        const char* name;
        double x, y;
    } cases[] = {{"D65", 0.3127, 0.3290},   {"D50", 0.3457, 0.3585},   {"A", 0.4476, 0.4074},
                 {"E", 0.3333, 0.3333},     {"F2", 0.3721, 0.3753},    {"F11", 0.3805, 0.3771},
                 {"2856K", 0.4476, 0.4074}, {"6504K", 0.3127, 0.3291}, {"0.31,0.32", 0.31, 0.32}};
    for (const auto& [name, x, y] : cases) {
        const Chromaticity white = named(name);
        EXPECT_NEAR(white.x, x, 1.01e-4) << name;
        EXPECT_NEAR(white.y, y, 1.01e-4) << name;
    }
    EXPECT_EQ(named("D65"), (Chromaticity{0.3127, 0.3290}));  // what sRGB calls D65: nothing is adapted
    EXPECT_EQ(std::get<image::Rect>(*parse_white("3,4,10,20")), (image::Rect{3, 4, 13, 24}));
}

using Whites = PrintTest;

// Light of the white's chromaticity and luminance y prints as the grey 1 - 2^-y, with either adaptation.
TEST_F(Whites, LightOfTheWhitePrintsAsTheGreyOfItsLuminance) {
    for (const std::string text : {"D65", "D50", "A", "E", "F11", "2000K", "5200K", "20000K", "0.4,0.42"}) {
        const color::Xyz white = color::xyz_from_chromaticity(named(text));
        const auto luminance = [](int x) { return std::exp2(-8 + x / 6.0); };
        write_picture(folder_ / "a.exr", {60, 4}, [&](int x, int) -> std::array<float, 3> {
            const double y = luminance(x);
            return {static_cast<float>(y * white.x), static_cast<float>(y), static_cast<float>(y * white.z)};
        });
        for (const char* adapt : {"bradford", "cat16"}) {
            SCOPED_TRACE(text + " " + adapt);
            ConvertOptions options;
            options.white = *parse_white(text);
            options.adapt = adapt;
            options.depth = Depth::k16;
            options.replace = true;
            const Result<ConvertReport> report = print("a.exr", "a.png", options);
            ASSERT_TRUE(report) << report.error().message;
            EXPECT_EQ(report->white, named(text));
            const Decoded png = image::decode_png(folder_ / "a.png");
            const auto* codes = reinterpret_cast<const std::uint16_t*>(png.pixels.data());
            for (int x = 0; x < 60; ++x) {
                const double printed = -std::expm1(-luminance(x) * std::log(2.0));
                // Rows are printed in float; blue has as little as 0.07 of the luminance.
                for (int c = 0; c < 3; ++c) EXPECT_NEAR(codes[3 * x + c], 65535 * color::Transfer::srgb().encode(printed), 3) << x;
            }
        }
    }
}

TEST_F(Whites, TheOwnWhiteByNamePrintsLikeNoWhiteAtAll) {
    write_picture(folder_ / "a.exr", {});
    ConvertOptions options;
    options.dither = color::Dither::kNone;
    ASSERT_TRUE(print("a.exr", "default.png", options));
    options.white = *parse_white("D65");
    ASSERT_TRUE(print("a.exr", "d65.png", options));
    options.white = *parse_white("A");
    ASSERT_TRUE(print("a.exr", "a.png", options));
    const Bytes own = image::decode_png(folder_ / "default.png").pixels, d65 = image::decode_png(folder_ / "d65.png").pixels;
    std::size_t other = 0;  // the file has 0.3127 as a float, 1e-9 away: a rounding may turn over
    for (std::size_t i = 0; i < own.size(); ++i) {
        other += own[i] != d65[i];
        ASSERT_NEAR(static_cast<int>(own[i]), static_cast<int>(d65[i]), 1);
    }
    EXPECT_LT(other, own.size() / 10000);
    EXPECT_FALSE(own == image::decode_png(folder_ / "a.png").pixels);
}

// A card of (0.42, 0.39), broken pixels in it, in a picture of any colours.
TEST_F(Whites, PixelsOfAGreyCardPrintGreyAndTheReportedNumberGivesTheSamePrint) {
    const color::Xyz white = color::xyz_from_chromaticity({0.42, 0.39});
    const image::Rect card{40, 30, 90, 70};
    PictureLayout tiled{300, 200, {}, 64};
    write_picture(folder_ / "a.exr", tiled, [&](int x, int y) -> std::array<float, 3> {
        if (x < card.x0 || x >= card.x1 || y < card.y0 || y >= card.y1) return colourful(x, y);
        if (x == 50 && y == 50) return {std::nanf(""), 1, INFINITY};
        const double light = 0.1 + 0.01 * (x - card.x0);
        return {static_cast<float>(light * white.x), static_cast<float>(light), static_cast<float>(light * white.z)};
    });
    const testing::Outcome measured = run_tool({at("a.exr"), "-o", at("card.png"), "--white", "40,30,50,40"});
    ASSERT_EQ(measured.status, 3) << measured.err;
    EXPECT_NE(measured.out.find("white          0.42,0.39, bradford\n"), std::string::npos) << measured.out;
    ASSERT_EQ(run_tool({at("a.exr"), "-o", at("given.png"), "--white", "0.42,0.39", "--threads", "1"}).status, 3);
    EXPECT_TRUE(image::decode_png(folder_ / "card.png").pixels == image::decode_png(folder_ / "given.png").pixels);

    ASSERT_EQ(run_tool({at("a.exr"), "-o", at("plain.png"), "--white", "40,30,50,40", "--no-dither"}).status, 3);
    const Decoded png = image::decode_png(folder_ / "plain.png");
    for (int y = card.y0; y < card.y1; ++y) {
        for (int x = card.x0; x < card.x1; ++x) {
            if (x == 50 && y == 50) continue;
            const std::byte* pixel =
                &png.pixels[static_cast<std::size_t>(y) * png.format.row_bytes() + 3 * static_cast<std::size_t>(x)];
            ASSERT_NEAR(static_cast<int>(pixel[0]), static_cast<int>(pixel[1]), 1);
            ASSERT_NEAR(static_cast<int>(pixel[2]), static_cast<int>(pixel[1]), 1);
        }
    }
}

TEST_F(Whites, EveryFormatNamesTheWhiteAndTheAdaptation) {
    write_picture(folder_ / "a.exr", {30, 20});
    for (const char* name : {"a.png", "a.tif", "a.jpg", "print.exr"}) {
        ASSERT_EQ(run_tool({at("a.exr"), "-o", at(name), "--white", "A", "--adapt", "cat16"}).status, 0);
        const std::string text = testing::read_text(folder_ / name);
        for (const char* fact : {"0.4476,0.4074", "cat16"}) EXPECT_NE(text.find(fact), std::string::npos) << name << " " << fact;
    }
}

TEST_F(Whites, WhitesThatAreNoneAreRefusedInOneLine) {
    write_picture(folder_ / "a.exr", {30, 20}, [](int x, int) -> std::array<float, 3> {
        return x < 10 ? std::array<float, 3>{} : std::array<float, 3>{1, 1, 1};
    });
    const std::vector<std::string> names = folder_.names();
    const struct {
        std::string white;
        int status;
        std::string says;
    } cases[] = {{"D66", 2, "try D65"},
                 {"", 2, "--white"},
                 {"K", 2, "try D65"},
                 {"900K", 2, "1000K to 25000K"},
                 {"26000K", 2, "25000K"},
                 {"nanK", 2, "25000K"},
                 {"0.3", 2, "try D65"},
                 {"0.3,0.3,0.4", 2, "try D65"},
                 {"0.7,0.4", 2, "--white"},
                 {"0.3,0", 2, "--white"},
                 {"0,0,0,5", 2, "try D65"},
                 {"0.5,0,5,5", 2, "try D65"},
                 {"0,0,31,5", 2, "0,0 to 30,20"},
                 {"0,0,1e9,1e9", 2, "0,0 to 30,20"},
                 {"0,0,1e10,1", 2, "try D65"},
                 {"0,0,10,10", 1, "no light"}};
    for (const auto& [white, status, says] : cases) {
        const testing::Outcome outcome = run_tool({at("a.exr"), "-o", at("b.png"), "--white", white});
        EXPECT_EQ(outcome.status, status) << white << ": " << outcome.err;
        EXPECT_NE(outcome.err.find(says), std::string::npos) << white << ": " << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_EQ(folder_.names(), names);
    }
    EXPECT_EQ(run_tool({at("a.exr"), "-o", at("b.png"), "--adapt", "von-kries"}).status, 2);
}

}  // namespace
}  // namespace latent::convert
