#include "tools/develop/film/positions.h"

#include <algorithm>

namespace latent::develop {

using sampledb::NodePart;

PositionRect positions_of(const sampledb::PageInfo& page) {
    const std::uint64_t side = std::uint64_t{1} << (32 - page.node.level);
    const std::uint64_t u = page.node.x * side, v = page.node.y * side, half = side / 2;
    const auto range = [](std::uint64_t from, std::uint64_t end) {
        return PositionRange{static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(end - 1)};
    };
    return {range(u, u + side),
            range(page.part == NodePart::kLower ? v + half : v, page.part == NodePart::kUpper ? v + half : v + side)};
}

// A record at position p reaches pixels j - reach .. j + reach - 1, where j = floor(p pixels / 2^32 + 1/2).
PositionRange positions_reaching(std::int64_t from, std::int64_t to, std::uint32_t pixels, int reach) {
    constexpr std::int64_t kOne = std::int64_t{1} << 32, kHalf = kOne / 2;
    const std::int64_t count = pixels, first_j = from - reach + 1, end_j = to + reach;
    const auto first_at = [&](std::int64_t j) {  // the first position with at least this j
        return std::clamp<std::int64_t>((j * kOne - kHalf + count - 1) / count, 0, kOne);
    };
    return {static_cast<std::uint32_t>(first_at(first_j)),
            static_cast<std::uint32_t>(std::max<std::int64_t>(first_at(end_j) - 1, 0))};
}

}  // namespace latent::develop
