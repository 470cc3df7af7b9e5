#include "tools/develop/refocused.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sampledb/codec/page_filter.h"
#include "sampledb/data/z_order.h"
#include "tools/develop/lens_columns.h"

namespace latent::develop {

using sampledb::FilmNode;
using sampledb::Page;
using sampledb::PageInfo;

Refocused::Refocused(const sampledb::Gathering& all, const std::array<double, 2>& shift)
    : all_(all), shift_(shift), columns_(*lens_columns(all.job())) {}

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
    sampledb::ColumnSet needed = columns;
    needed.positions = needed.extra = true;
    if (Status s = all_.read_page(run, *its_own, needed, decoder, page); !s) return s;
    move(page);
    return {};
}

void Refocused::move(Page& page) const {
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < page.count; ++row) {
        const std::array<double, 2> lens = lens_point(page, columns_, row);
        const double u = page.u[row] * 0x1p-32 + shift_[0] * lens[0], v = page.v[row] * 0x1p-32 + shift_[1] * lens[1];
        if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) continue;
        page.u[row] = static_cast<std::uint32_t>(u * 0x1p32), page.v[row] = static_cast<std::uint32_t>(v * 0x1p32);
        rows.push_back(row);
    }
    std::ranges::stable_sort(rows, {}, [&page](std::size_t row) { return sampledb::z_prefix(page.u[row], page.v[row]); });
    sampledb::keep_rows(rows, page);
}

}  // namespace latent::develop
