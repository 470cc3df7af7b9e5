#include "tools/convert/bands.h"

#include <gtest/gtest.h>

namespace latent::convert {
namespace {

using image::Rect;

// Every pixel of the area is in exactly one block, blocks begin at even distances from its corner, and a smaller budget only means
// smaller bands.
TEST(Bands, BlocksCoverTheAreaOnceAndKeepPairsOfPixelsTogether) {
    for (const int tile : {0, 1, 16, 64, 256}) {
        for (const Rect& area : {Rect{0, 0, 700, 900}, {3, 5, 640, 611}, {1, 1, 2, 2}, {699, 0, 700, 900}, {0, 899, 700, 900}}) {
            for (const std::uint64_t memory : {std::uint64_t{8} << 20, std::uint64_t{1} << 30}) {
                SCOPED_TRACE(::testing::Message()
                             << "tile " << tile << ", area " << area.x0 << "," << area.y0 << "," << area.x1 << "," << area.y1);
                image::ExrImage image;
                image.data_window = {0, 0, 700, 900};
                image.block_width = tile == 0 ? 700 : tile;
                image.block_height = tile == 0 ? 16 : tile;
                const Result<BandPlan> plan = plan_bands(image, area, {3 * 700, 100000}, memory, 2);
                ASSERT_TRUE(plan) << plan.error().message;
                std::vector<char> covered(700 * 900);
                int end = area.y0;
                for (std::size_t i = 0; i < plan->band_ends.size(); ++i) {
                    const Rect band = plan->band(i);
                    EXPECT_EQ(band.y0, end);
                    EXPECT_GT(band.y1, band.y0);
                    end = band.y1;
                    for (const Rect& block : plan->blocks(band)) {
                        EXPECT_TRUE(band.contains(block));
                        EXPECT_EQ((block.x0 - area.x0) % 2, 0);
                        EXPECT_EQ((block.y0 - area.y0) % 2, 0);
                        for (int y = block.y0; y < block.y1; ++y) {
                            for (int x = block.x0; x < block.x1; ++x) ++covered[static_cast<std::size_t>(y * 700 + x)];
                        }
                    }
                }
                EXPECT_EQ(end, area.y1);
                std::size_t once = 0, other = 0;
                for (const char times : covered) (times == 1 ? once : other) += times != 0;
                EXPECT_EQ(once, area.pixels());
                EXPECT_EQ(other, 0u);
            }
        }
    }
}

TEST(Bands, BlocksOfAWholePictureAreTheFilesOwn) {
    image::ExrImage image;
    image.data_window = {0, 0, 1024, 1024};
    image.block_width = image.block_height = 256;
    const Result<BandPlan> plan = plan_bands(image, image.data_window, {3 * 1024, 0}, std::uint64_t{1} << 30, 2);
    ASSERT_TRUE(plan);
    for (std::size_t i = 0; i < plan->band_ends.size(); ++i) {
        for (const Rect& block : plan->blocks(plan->band(i))) {
            EXPECT_EQ(block.x0 % 256 + block.y0 % 256, 0);
            EXPECT_EQ(block.pixels(), std::size_t{256} * 256);
        }
    }
}

TEST(Bands, APictureTooWideForTheMemorySaysHowMuchItNeeds) {
    image::ExrImage image;
    image.data_window = {0, 0, 1 << 20, 1000};
    image.block_width = image.block_height = 256;
    const Result<BandPlan> plan =
        plan_bands(image, image.data_window, {std::size_t{12} << 20, std::size_t{100} << 20}, std::uint64_t{64} << 20, 2);
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().code, ErrorCode::kUsage);
    const std::string& message = plan.error().message;
    const std::size_t number = message.find("at least ");
    ASSERT_NE(number, std::string::npos) << message;
    const std::uint64_t enough = std::stoull(message.substr(number + 9)) << 20;
    EXPECT_TRUE(plan_bands(image, image.data_window, {std::size_t{12} << 20, std::size_t{100} << 20}, enough, 2));
}

}  // namespace
}  // namespace latent::convert
