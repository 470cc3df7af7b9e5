// What the report says of a picture: percentiles, and the pixels that print black or white, whatever the threads.
#include "tools/convert/report.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

using Report = PrintTest;

// A ramp of greys from 2^-24 to 2^6, and one row without light.
constexpr int kWidth = 2600, kHeight = 8;
std::array<float, 3> ramp(int x, int y) {
    if (y == 0) return {0, 0, 0};
    const double light = std::exp2(-24 + 30.0 * (x + 0.5) / kWidth);
    return {static_cast<float>(light * 0.3127 / 0.3290), static_cast<float>(light), static_cast<float>(light * 0.3583 / 0.3290)};
}

TEST_F(Report, PercentilesAreThoseOfThePicturesLuminances) {
    write_picture(folder_ / "a.exr", {kWidth, kHeight, {}, 64}, ramp);
    const Result<ConvertReport> report = print("a.exr", "a.png");
    ASSERT_TRUE(report);
    for (std::size_t i = 0; i < kPercentiles.size(); ++i) {
        const double lit = (kPercentiles[i] / 100.0 * kHeight - 1) / (kHeight - 1);  // share of the pixels that have light
        const double exact = lit <= 0 ? 0 : std::exp2(-24 + 30 * lit);
        EXPECT_NEAR(report->luminance[i], exact, exact * (1.0 / 128 + 30.0 * std::log(2.0) / kWidth)) << kPercentiles[i];
    }
    ConvertOptions one;
    one.threads = 1;
    one.memory = 24 << 20;
    const Result<ConvertReport> alone = print("a.exr", "b.png", one);
    ASSERT_TRUE(alone) << alone.error().message;
    EXPECT_EQ(alone->luminance, report->luminance);
}

TEST_F(Report, BlackAndBurntPixelsAreThoseOfCodes0And255) {
    write_picture(folder_ / "a.exr", {kWidth, kHeight, {}, 64}, ramp);
    for (const char* profile : {"srgb", "rec2020", "adobe-rgb"}) {
        for (const char* tone : {"film", "none"}) {
            SCOPED_TRACE(std::string(profile) + " " + tone);
            ConvertOptions options;
            options.profile = profile;
            options.tone = tone;
            options.sensitivity = 2;
            options.dither = color::Dither::kNone;
            options.replace = true;
            const Result<ConvertReport> report = print("a.exr", "a.png", options);
            ASSERT_TRUE(report);
            const image::Decoded png = image::decode_png(folder_ / "a.png");
            std::uint64_t black = 0, burnt = 0;
            for (std::size_t i = 1; i < png.pixels.size(); i += 3) {  // green of a grey
                black += png.pixels[i] == std::byte{0};
                burnt += png.pixels[i] == std::byte{255};
            }
            EXPECT_GT(black, std::uint64_t{kWidth});
            EXPECT_GT(burnt, 100u);
            // Rows are printed and encoded in float: where the ramp passes half a step, a pixel of each row may fall on either
            // side.
            EXPECT_NEAR(static_cast<double>(report->print.black), static_cast<double>(black), kHeight);
            EXPECT_NEAR(static_cast<double>(report->print.burnt), static_cast<double>(burnt), kHeight);
        }
    }
}

TEST_F(Report, TextAndJsonHaveTheSameNumbers) {
    write_picture(folder_ / "a.exr", {100, 10}, [](int x, int) -> std::array<float, 3> {
        if (x < 25) return {0, 0, 0};
        if (x >= 90) return {0.9505f * 64, 64, 1.089f * 64};
        return {0.9505f, 1, 1.089f};
    });
    const testing::Outcome text = run_tool({at("a.exr"), "-o", at("a.png")});
    ASSERT_EQ(text.status, 0) << text.err;
    for (const char* line : {"luminance      1 %: 0, 10 %: 0, 50 %: ", "black          250 pixels (25.000 %)\n",
                             "burnt          100 pixels (10.000 %)\n"})
        EXPECT_NE(text.out.find(line), std::string::npos) << text.out;
    const auto json = nlohmann::json::parse(run_tool({at("a.exr"), "-o", at("b.png"), "--json"}).out);
    EXPECT_EQ(json["gamut"], "luminance");
    const auto unmapped = nlohmann::json::parse(run_tool({at("a.exr"), "-o", at("c.exr"), "--tone", "none", "--json"}).out);
    EXPECT_EQ(unmapped["gamut"], "none");
    EXPECT_EQ(json["black"], 250);
    EXPECT_EQ(json["burnt"], 100);
    EXPECT_EQ(json["luminance"]["p10"], 0);
    EXPECT_NEAR(json["luminance"]["p50"].get<double>(), 1, 1.0 / 128);
    EXPECT_NEAR(json["luminance"]["p99"].get<double>(), 64, 0.5);
}

}  // namespace
}  // namespace latent::convert
