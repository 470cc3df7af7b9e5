// The page beside a Deep Zoom pyramid, in a real browser.
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/convert/test_picture.h"
#include "tests/support/paths.h"

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

    struct Seen {
        std::vector<Decoded> views;
        nlohmann::json facts;  // the browser's own account
    };
    // What the browser shows of `page` at each view, "X,Y,SCALE".
    Seen look(const std::string& page, const std::vector<std::string>& views) const {
        std::vector<std::string> command = {"/usr/bin/env", "node", latent::testing::in_tree("tests/convert/browser/look.mjs"),
                                            at(page), folder_.path()};
        command.insert(command.end(), views.begin(), views.end());
        const testing::Outcome outcome = testing::run(command);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        Seen seen{std::vector<Decoded>(views.size()), {}};
        if (outcome.status != 0) return seen;
        seen.facts = nlohmann::json::parse(outcome.out);
        for (std::size_t i = 0; i < views.size(); ++i) seen.views[i] = image::decode_png(folder_ / fmt::format("seen-{}.png", i));
        return seen;
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

    const std::string view = fmt::format("{},{},1", (kSeen.x0 + kSeen.x1) / 2, (kSeen.y0 + kSeen.y1) / 2);
    const auto [lossless, facts] = look("lossless.html", {view});
    EXPECT_EQ(difference(lossless[0], crop), 0);
    EXPECT_LT(facts["before"], 12) << facts;  // 2600 pixels: level 12 is the whole; a window of 800 needs a quarter
    EXPECT_EQ(facts["after"], 12) << facts;
    EXPECT_GT(facts["tiles"], 10) << facts;
    EXPECT_EQ(facts["address"].get<std::string>()[0], '#');

    const auto [seen, more_facts] = look("jpeg &1.html", {view});
    const Decoded& jpeg = seen[0];
    ASSERT_EQ(jpeg.pixels.size(), crop.pixels.size());
    EXPECT_EQ(rows_unlike_tiles(jpeg, folder_ / "jpeg &1_files" / "12"), 0);
    EXPECT_LT(difference(jpeg, crop), 9);  // of noise at quality 90: steps of about 12 in Y and 20 in Cb and Cr, each over sqrt(12)
    EXPECT_EQ(more_facts["after"], 12) << more_facts;
    EXPECT_EQ(facts["title"], "lossless");
    EXPECT_EQ(more_facts["title"], "jpeg &1");
}

// Two prints on one page: left of the divider the new one, right of it the other, each as its crop prints.
TEST_F(DeepZoomPage, ADividerShowsTwoPrintsBesideEachOther) {
    std::filesystem::create_directory(folder_ / "older ones");
    ConvertOptions options;
    options.png_tiles = true;
    ASSERT_TRUE(print("a.exr", "older ones/a.dzi", options));
    ConvertOptions darker = options;
    darker.stops = {-2};
    darker.compare = folder_ / "older ones" / "a.dzi";
    ASSERT_TRUE(print("a.exr", "darker.dzi", darker));
    options.crop = darker.crop = kSeen;
    darker.compare.clear();
    ASSERT_TRUE(print("a.exr", "right.png", options));
    ASSERT_TRUE(print("a.exr", "left.png", darker));
    const Decoded left = image::decode_png(folder_ / "left.png"), right = image::decode_png(folder_ / "right.png");
    const std::string view = fmt::format("{},{},1,", (kSeen.x0 + kSeen.x1) / 2, (kSeen.y0 + kSeen.y1) / 2);
    const auto [seen, facts] = look("darker.html", {view + "0.25", view + "0", view + "1", view + "0.625"});
    ASSERT_EQ(seen[0].pixels.size(), left.pixels.size());
    EXPECT_NEAR(facts["split"].get<double>(), 0.75, 0.01) << facts;
    const std::array<std::size_t, 4> columns{200, 0, 800, 500};
    for (std::size_t i = 0; i < 4; ++i) {
        int unlike = 0;
        for (std::size_t y = 0; y < 600; ++y) {
            for (std::size_t x = 0; x < 800; ++x) {
                const Decoded& expected = x < columns[i] ? left : right;
                const std::size_t at = 3 * (y * 800 + x);
                unlike += std::memcmp(&seen[i].pixels[at], &expected.pixels[at], 3) != 0;
            }
        }
        EXPECT_LE(unlike, 600) << i;  // a column of pixels at the divider may be a mixture
    }
}

TEST_F(DeepZoomPage, OnlyPyramidsOfTheSameSizeAreCompared) {
    ASSERT_TRUE(print("a.exr", "a.dzi"));
    write_picture(folder_ / "small.exr", {40, 30});
    const auto refused = [&](std::vector<std::string> more, const char* words, int status) {
        more.insert(more.begin(), {at("small.exr")});
        const testing::Outcome outcome = run_tool(more);
        EXPECT_EQ(outcome.status, status) << outcome.err;
        EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(folder_ / "b.html"));
    };
    refused({"-o", at("b.dzi"), "--compare", at("a.dzi")}, "has 2600 x 1900 pixels, and this print 40 x 30", 2);
    refused({"-o", at("b.dzi"), "--compare", at("none.dzi")}, "none.dzi", 1);
    refused({"-o", at("b.dzi"), "--compare", at("small.exr")}, "not a Deep Zoom descriptor", 1);
    refused({"-o", at("b.png"), "--compare", at("a.dzi")}, "needs an output that ends in .dzi", 2);
}

// Of a picture of one colour every pixel that it covers has that colour: no seam between tiles, no background at the window's
// edges.
TEST_F(DeepZoomPage, MagnifiedItShowsNeitherSeamsNorBackground) {
    write_picture(folder_ / "plain.exr", {700, 500}, [](int, int) -> std::array<float, 3> { return {0.9f, 1, 1.1f}; });
    ConvertOptions options;
    options.png_tiles = true;
    options.dither = color::Dither::kNone;
    ASSERT_TRUE(print("plain.exr", "plain.dzi", options));
    ASSERT_TRUE(print("plain.exr", "plain.png", options));
    const Decoded plain = image::decode_png(folder_ / "plain.png");
    const auto alike = [&](const Decoded& seen, int width, int height) {  // of the rows and columns from the window's corner
        int pixels = 0;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x)
                pixels += std::memcmp(&seen.pixels[static_cast<std::size_t>(3 * (800 * y + x))], plain.pixels.data(), 3) == 0;
        }
        return pixels;
    };
    const auto [inside, facts] =
        look("plain.html", {"350,256,1.5", "256,256,2", "300.3,256.7,2.7", "400,250,3.3", "512,256,8", "690,490,2", "690,490,8"});
    // The navigator is in the corner; a click in its middle goes to the picture's, to within a pixel of the navigator: 700 / 160.
    EXPECT_NEAR(facts["map"]["x"].get<double>() + facts["map"]["width"].get<double>(), 800, 10) << facts;
    EXPECT_NEAR(facts["map"]["y"].get<double>() + facts["map"]["height"].get<double>(), 600, 10) << facts;
    EXPECT_NEAR(facts["middle"][0].get<double>(), 350, 5) << facts;
    EXPECT_NEAR(facts["middle"][1].get<double>(), 250, 5) << facts;
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(alike(inside[i], 800, 600), 800 * 600) << i;
    EXPECT_EQ(alike(inside[5], 420, 320), 420 * 320) << "pixel 690, 490 is in the middle, so the picture ends 10 pixels further";
    EXPECT_EQ(alike(inside[5], 800, 600), 420 * 320);
    EXPECT_EQ(alike(inside[6], 480, 380), 480 * 380);
    EXPECT_EQ(alike(inside[6], 800, 600), 480 * 380);
}

}  // namespace
}  // namespace latent::convert
