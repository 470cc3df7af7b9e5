// The page beside a Deep Zoom pyramid, in a real browser.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

using image::Decoded;

class DeepZoomPage : public PrintTest {
 protected:
    static constexpr int kWidth = 2600, kHeight = 1900;
    // The part of the picture that the browser is asked to show, pixel by pixel.
    static constexpr image::Rect kSeen{900, 700, 1700, 1300};

    // Slow drifts that tell every place from every other, and a little grain in every pixel that only the deepest level has.
    void SetUp() override {
        write_picture(folder_ / "a.exr", {kWidth, kHeight, {}, 256}, [](int x, int y) -> std::array<float, 3> {
            const float grain = 0.97f + 0.06f * static_cast<float>((x * 73 + y * 151) % 97) / 97;
            const float light = grain * (0.2f + std::exp2(static_cast<float>(y) / 600));
            return {light * (0.7f + 0.5f * std::sin(static_cast<float>(x) * 0.004f)), light,
                    light * (0.8f + 0.4f * std::cos(static_cast<float>(x + y) * 0.003f))};
        });
    }

    // What the browser shows of `page`, and its own account.
    Decoded look(const std::string& page, nlohmann::json& facts) const {
        const std::string view =
            "#" + std::to_string((kSeen.x0 + kSeen.x1) / 2) + "," + std::to_string((kSeen.y0 + kSeen.y1) / 2) + ",1";
        const testing::Outcome outcome = testing::run(
            {"/usr/bin/env", "node", LATENT_SOURCE_DIR "/tests/convert/browser/look.mjs", at(page), folder_.path(), view});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        if (outcome.status != 0) return {};
        facts = nlohmann::json::parse(outcome.out);
        return image::decode_png(folder_ / "seen.png");
    }

    // Root mean square of the differences of code values.
    double difference(const Decoded& a, const Decoded& b) const {
        EXPECT_EQ(a.pixels.size(), b.pixels.size());
        double sum = 0;
        for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i) {
            const double d = static_cast<int>(a.pixels[i]) - static_cast<int>(b.pixels[i]);
            sum += d * d;
        }
        return std::sqrt(sum / static_cast<double>(a.pixels.size()));
    }
};

TEST_F(DeepZoomPage, ZoomingInLoadsDeeperTilesAndShowsWhatACropPrints) {
    ConvertOptions options;
    options.png_tiles = true;
    options.overlap = 1;
    ASSERT_TRUE(print("a.exr", "lossless.dzi", options));
    ASSERT_TRUE(print("a.exr", "jpeg &1.dzi"));
    options.crop = kSeen;
    ASSERT_TRUE(print("a.exr", "crop.png", options));
    const Decoded crop = image::decode_png(folder_ / "crop.png");

    nlohmann::json facts;
    const Decoded lossless = look("lossless.html", facts);
    EXPECT_EQ(difference(lossless, crop), 0);
    EXPECT_LT(facts["before"], 12) << facts;  // 2600 pixels: level 12 is the whole; a window of 800 needs a quarter
    EXPECT_EQ(facts["after"], 12) << facts;
    EXPECT_GT(facts["tiles"], 10) << facts;
    EXPECT_EQ(facts["address"].get<std::string>()[0], '#');

    const Decoded jpeg = look("jpeg &1.html", facts);
    EXPECT_LT(difference(jpeg, crop), 3);  // quality 90
    EXPECT_EQ(facts["after"], 12) << facts;
}

}  // namespace
}  // namespace latent::convert
