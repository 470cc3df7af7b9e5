#include "tools/develop/engine/spot.h"

#include <algorithm>
#include <utility>

#include "sampledb/codec/page_filter.h"

namespace latent::develop {

using sampledb::NodePart;
using sampledb::PageInfo;

namespace {

// Where the records of a page may lie.
std::pair<PositionRange, PositionRange> positions_of(const PageInfo& page) {
    const std::uint64_t side = std::uint64_t{1} << (32 - page.node.level);
    const std::uint64_t u = page.node.x * side, v = page.node.y * side, half = side / 2;
    const auto range = [](std::uint64_t from, std::uint64_t end) {
        return PositionRange{static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(end - 1)};
    };
    return {range(u, u + side),
            range(page.part == NodePart::kLower ? v + half : v, page.part == NodePart::kUpper ? v + half : v + side)};
}

}  // namespace

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

Result<std::shared_ptr<const std::vector<PageInfo>>> Spot::pages(std::size_t run) const {
    const auto all = all_.pages(run);
    if (!all) return all.error();
    auto reaching = std::make_shared<std::vector<PageInfo>>();
    for (const PageInfo& page : **all) {
        const auto [u, v] = positions_of(page);
        if (u_.meets(u) && v_.meets(v)) reaching->push_back(page);
    }
    return std::shared_ptr<const std::vector<PageInfo>>(std::move(reaching));
}

Status Spot::read_page(std::size_t run, const PageInfo& info, const sampledb::ColumnSet& columns, sampledb::PageDecoder& decoder,
                       sampledb::Page& page) const {
    if (Status s = all_.read_page(run, info, columns, decoder, page); !s) return s;
    const auto [u, v] = positions_of(info);
    if (u_.holds(u) && v_.holds(v)) return {};
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < page.count; ++row) {
        if (u_.holds(page.u[row]) && v_.holds(page.v[row])) rows.push_back(row);
    }
    if (rows.size() < page.count) sampledb::keep_rows(rows, page);
    return {};
}

}  // namespace latent::develop
