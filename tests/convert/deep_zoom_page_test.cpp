// The page beside a Deep Zoom pyramid, in a real browser.
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

using image::Decoded;

class DeepZoomPage : public PrintTest {
 protected:
    static constexpr int kWidth = 2600, kHeight = 1900, kTile = 256;
    // The part of the picture that the browser is asked to show, pixel by pixel.
    static constexpr image::Rect kSeen{900, 700, 1700, 1300};

    // Slow drifts that tell every place from every other, and in every pixel noise that only the deepest level has: what is moved
    // or stretched by a part of a pixel is seen.
    void SetUp() override {
        std::mt19937 random(1);
        write_picture(folder_ / "a.exr", {kWidth, kHeight, {}, 256}, [&random](int x, int y) -> std::array<float, 3> {
            const auto noise = [&random] { return 0.25f + 1.5f * static_cast<float>(random()) * 0x1p-32f; };
            const float light = 0.2f + std::exp2(static_cast<float>(y) / 600);
            const float red = light * (0.7f + 0.5f * std::sin(static_cast<float>(x) * 0.004f)) * noise();
            const float green = light * noise();
            return {red, green, light * (0.8f + 0.4f * std::cos(static_cast<float>(x + y) * 0.003f)) * noise()};
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

    // Rows of the tiles `files`/COLUMN_ROW.jpg, decoded, that `seen` shows otherwise; of pixels that are in one tile only, as a
    // viewer may show any tile's. No tile seen is the first of its row or column, so the pixels of each begin at 1, 1.
    int rows_unlike_tiles(const Decoded& seen, const std::filesystem::path& files) const {
        const auto pixel = [](const Decoded& in, int x, int y) {
            return in.pixels.data() + static_cast<std::size_t>(y) * in.format.row_bytes() + 3 * static_cast<std::size_t>(x);
        };
        int unlike = 0;
        for (int top = kSeen.y0 / kTile * kTile; top < kSeen.y1; top += kTile) {
            for (int left = kSeen.x0 / kTile * kTile; left < kSeen.x1; left += kTile) {
                const Decoded tile = image::decode_jpeg(files / fmt::format("{}_{}.jpg", left / kTile, top / kTile));
                const int x0 = std::max(kSeen.x0, left + 1), x1 = std::min(kSeen.x1, left + kTile - 1);
                for (int y = std::max(kSeen.y0, top + 1); y < std::min(kSeen.y1, top + kTile - 1); ++y)
                    unlike += std::memcmp(pixel(seen, x0 - kSeen.x0, y - kSeen.y0), pixel(tile, x0 - left + 1, y - top + 1),
                                          3 * static_cast<std::size_t>(x1 - x0)) != 0;
            }
        }
        return unlike;
    }
};

TEST_F(DeepZoomPage, ZoomingInLoadsDeeperTilesAndShowsWhatACropPrints) {
    ConvertOptions options;
    options.png_tiles = true;
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
    ASSERT_EQ(jpeg.pixels.size(), crop.pixels.size());
    EXPECT_EQ(rows_unlike_tiles(jpeg, folder_ / "jpeg &1_files" / "12"), 0);
    EXPECT_LT(difference(jpeg, crop), 9);  // of noise at quality 90: steps of about 12 in Y and 20 in Cb and Cr, each over sqrt(12)
    EXPECT_EQ(facts["after"], 12) << facts;
}

}  // namespace
}  // namespace latent::convert
