#include "tools/develop/lens/refocused.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace latent::develop {

using sampledb::FilmNode;
using sampledb::Page;
using sampledb::PageInfo;

// The smallest node that holds what the records of a node may be moved to.
FilmNode Refocused::reached_from(const FilmNode& node) const {
    const auto range = [&](std::uint32_t at, double shift) {
        const double side = std::ldexp(1.0, -node.level), reach = std::abs(shift);
        const auto place = [](double x) { return static_cast<std::uint32_t>(std::clamp(x, 0.0, 1 - 0x1p-32) * 0x1p32); };
        return std::array{place(at * side - reach), place((at + 1) * side + reach)};
    };
    const std::array<std::uint32_t, 2> u = range(node.x, shift_[0]), v = range(node.y, shift_[1]);
    FilmNode reached{node.level, 0, 0};
    const auto cut = [&](std::uint32_t position) { return reached.level == 0 ? 0 : position >> (32 - reached.level); };
    while (cut(u[0]) != cut(u[1]) || cut(v[0]) != cut(v[1])) --reached.level;
    reached.x = cut(u[0]), reached.y = cut(v[0]);
    return reached;
}

Result<std::shared_ptr<const std::vector<PageInfo>>> Refocused::pages(std::size_t run) const {
    const auto stored = all_.pages(run);
    if (!stored) return stored.error();
    auto moved = std::make_shared<std::vector<PageInfo>>(**stored);
    for (PageInfo& page : *moved) {
        page.node = reached_from(page.node);
        page.part = sampledb::NodePart::kAnywhere;
    }
    return std::shared_ptr<const std::vector<PageInfo>>(std::move(moved));
}

Status Refocused::read_page(std::size_t run, const PageInfo& info, const sampledb::ColumnSet& columns,
                            sampledb::PageDecoder& decoder, Page& page) const {
    const auto stored = all_.pages(run);
    if (!stored) return stored.error();
    const auto its_own = std::ranges::lower_bound(**stored, info.offset, {}, &PageInfo::offset);
    assert(its_own != (*stored)->end() && its_own->offset == info.offset);
    return all_.read_page(run, *its_own, columns, decoder, page);
}

}  // namespace latent::develop
