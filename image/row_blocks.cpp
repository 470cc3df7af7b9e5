#include "image/row_blocks.h"

#include <algorithm>
#include <cassert>

namespace latent::image {

RowBlocks::RowBlocks(int image_height, std::size_t row_bytes, int block_height, int above, int below)
    : height_(image_height), block_height_(block_height), above_(above), below_(below), row_bytes_(row_bytes) {}

const std::byte* RowBlocks::row(int y) const {
    return y < fresh_first_ ? kept_.data() + static_cast<std::size_t>(y - kept_first_) * row_bytes_
                            : fresh_.data() + static_cast<std::size_t>(y - fresh_first_) * row_bytes_;
}

std::vector<RowBlock> RowBlocks::take(ByteSpan rows) {
    assert(fresh_.empty() && rows.size() % row_bytes_ == 0);
    fresh_ = rows;
    end_ = fresh_first_ + static_cast<int>(rows.size() / row_bytes_);
    assert(end_ <= height_);
    std::vector<RowBlock> blocks;
    while (next_block_ < height_) {
        RowBlock block;
        block.first = next_block_;
        block.count = std::min(block_height_, height_ - next_block_);
        block.above = std::min(above_, block.first);
        block.below = std::min(below_, height_ - block.first - block.count);
        if (block.first + block.count + block.below > end_) break;
        for (int y = block.first - block.above; y < block.first + block.count + block.below; ++y) block.rows.push_back(row(y));
        blocks.push_back(std::move(block));
        next_block_ += block_height_;
    }
    return blocks;
}

void RowBlocks::settle() {
    const int first = std::clamp(next_block_ - above_, kept_first_, end_);
    if (first > kept_first_) {
        const int dropped = std::min(first, fresh_first_) - kept_first_;
        kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(dropped) * row_bytes_));
    }
    const int fresh_kept = std::max(first, fresh_first_);
    kept_.insert(kept_.end(),
                 fresh_.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(fresh_kept - fresh_first_) * row_bytes_),
                 fresh_.end());
    kept_first_ = first;
    fresh_first_ = end_;
    fresh_ = {};
}

}  // namespace latent::image
