#include "image/row_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>

namespace latent::image {
namespace {

// Rows of one byte that holds their number: blocks must hold the rows that they say, however the rows arrive.
TEST(RowBlocks, EveryBlockHoldsItsRowsAndItsNeighbours) {
    for (const int height : {1, 2, 7, 16, 17, 40}) {
        for (const int block : {1, 3, 16}) {
            for (const int around : {0, 1, 2}) {
                for (const int piece : {1, 2, 5, 40}) {
                    SCOPED_TRACE(::testing::Message()
                                 << height << " rows in blocks of " << block << " +- " << around << ", " << piece << " at a time");
                    RowBlocks blocks(height, 1, block, around, around);
                    int next = 0;
                    for (int y = 0; y < height; y += piece) {
                        std::vector<std::byte> rows;
                        for (int i = y; i < std::min(height, y + piece); ++i) rows.push_back(std::byte(i));
                        for (const RowBlock& b : blocks.take(rows)) {
                            EXPECT_EQ(b.first, next);
                            EXPECT_EQ(b.count, std::min(block, height - b.first));
                            EXPECT_EQ(b.above, std::min(around, b.first));
                            EXPECT_EQ(b.below, std::min(around, height - b.first - b.count));
                            ASSERT_EQ(b.rows.size(), static_cast<std::size_t>(b.above + b.count + b.below));
                            for (std::size_t i = 0; i < b.rows.size(); ++i) {
                                EXPECT_EQ(static_cast<int>(*b.rows[i]), b.first - b.above + static_cast<int>(i));
                            }
                            next += block;
                        }
                        blocks.settle();
                        std::fill(rows.begin(), rows.end(), std::byte{0xff});
                        EXPECT_LE(blocks.kept_bytes(), static_cast<std::size_t>(block + 2 * around));
                    }
                    EXPECT_GE(next, height);
                }
            }
        }
    }
}

}  // namespace
}  // namespace latent::image
