#include "tools/convert/pyramid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace latent::convert {
namespace {

float light(int x, int y, std::size_t c) { return static_cast<float>((x * 7 + y * 13 + static_cast<int>(c) * 5) % 64) / 64; }

// Level n, straight from the definition: the mean of what there is of 2 x 2 pixels of level n - 1. Sums of 64ths are exact here.
std::vector<PlanarRows> reference(int width, int height, std::size_t levels) {
    std::vector<PlanarRows> all(2, PlanarRows(width, height));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (std::size_t c = 0; c < 3; ++c) all[1].plane(y, c)[x] = light(x, y, c);
        }
    }
    while (all.size() < levels) {
        PlanarRows& last = all.back();
        PlanarRows next((last.width + 1) / 2, (last.height + 1) / 2);
        for (int y = 0; y < next.height; ++y) {
            for (int x = 0; x < next.width; ++x) {
                for (std::size_t c = 0; c < 3; ++c) {
                    double sum = 0;
                    int count = 0;
                    for (int j = 2 * y; j < std::min(last.height, 2 * y + 2); ++j) {
                        for (int i = 2 * x; i < std::min(last.width, 2 * x + 2); ++i, ++count)
                            sum += static_cast<double>(last.plane(j, c)[i]);
                    }
                    next.plane(y, c)[x] = static_cast<float>(sum / count);
                }
            }
        }
        all.push_back(next);
    }
    return all;
}

TEST(Pyramid, EveryLevelIsTheMeanOfTheLevelAboveHoweverTheRowsArrive) {
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 2}, {5, 3}, {64, 48}, {33, 77}}) {
        std::size_t levels = 2;
        for (int side = std::max(width, height); side > 1; side = (side + 1) / 2) ++levels;
        const std::vector<PlanarRows> expected = reference(width, height, levels);
        for (const int piece : {1, 2, 3, 16, 100}) {
            SCOPED_TRACE(::testing::Message() << width << " x " << height << " in pieces of " << piece);
            Pyramid pyramid(height, levels);
            std::vector<std::vector<float>> found(levels);
            for (int y = 0; y < height; y += piece) {
                const int rows = std::min(piece, height - y);
                PlanarRows some(width, rows);
                std::copy_n(expected[1].plane(y, 0), some.values.size(), some.values.begin());
                const Status status = pyramid.add(some, [&](std::size_t level, int first, const PlanarRows& made) -> Status {
                    EXPECT_EQ(found[level].size(), static_cast<std::size_t>(first) * 3 * static_cast<std::size_t>(made.width));
                    found[level].insert(found[level].end(), made.values.begin(), made.values.end());
                    return {};
                });
                ASSERT_TRUE(status);
            }
            for (std::size_t level = 1; level < levels; ++level) {
                ASSERT_EQ(found[level].size(), expected[level].values.size()) << "level " << level;
                for (std::size_t i = 0; i < found[level].size(); ++i)
                    EXPECT_NEAR(found[level][i], expected[level].values[i], 1e-6f);
            }
        }
    }
}

TEST(Pyramid, ACheckerBoardOfBlackAndWhiteIsHalfTheLightFromAfar) {
    const float black_white[] = {0, 1, 0, 1}, white_black[] = {1, 0, 1, 0};
    float out[2];
    halve(black_white, white_black, 4, out);
    EXPECT_EQ(out[0], 0.5f);
    EXPECT_EQ(out[1], 0.5f);
    const float beyond[] = {7, 0, -3, 1};  // a display cannot shine brighter than white, nor take light away
    halve(beyond, nullptr, 4, out);
    EXPECT_EQ(out[0], 0.5f);
    EXPECT_EQ(out[1], 0.5f);
}

}  // namespace
}  // namespace latent::convert
