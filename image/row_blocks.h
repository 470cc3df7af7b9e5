// image/row_blocks.h: cuts a stream of rows, however it arrives, into blocks of a fixed number of rows.
#pragma once

#include <vector>

#include "base/bytes.h"

namespace latent::image {

// Rows [first, first + count) of the image, and the rows around them where there are any.
struct RowBlock {
    int first = 0, count = 0;
    int above = 0, below = 0;            // rows of the neighbours that `rows` holds before and after the block's own
    std::vector<const std::byte*> rows;  // above + count + below of them
};

class RowBlocks {
 public:
    // `above`, `below`: how many rows of its neighbours each block wants to see.
    RowBlocks(int image_height, std::size_t row_bytes, int block_height, int above = 0, int below = 0);

    // Takes the next rows; returns the blocks that are complete with them. Pointers hold until `settle` or the end of `rows`.
    std::vector<RowBlock> take(ByteSpan rows);
    // Keeps what later blocks need of the rows taken last; call it when the blocks have been used.
    void settle();

    std::size_t kept_bytes() const { return kept_.size(); }

 private:
    const std::byte* row(int y) const;

    int height_, block_height_, above_, below_;
    std::size_t row_bytes_;
    int next_block_ = 0;  // first row of the next block
    Bytes kept_;          // rows kept_first_ .. fresh_first_
    int kept_first_ = 0;
    int fresh_first_ = 0;  // rows fresh_first_ .. end_ are in fresh_
    int end_ = 0;
    ByteSpan fresh_;
};

}  // namespace latent::image
