#include "tools/develop/engine/spot.h"

#include <utility>

#include "sampledb/codec/page_filter.h"

namespace latent::develop {

using sampledb::PageInfo;

Result<std::shared_ptr<const std::vector<PageInfo>>> Spot::pages(std::size_t run) const {
    const auto all = all_.pages(run);
    if (!all) return all.error();
    auto reaching = std::make_shared<std::vector<PageInfo>>();
    for (const PageInfo& page : **all) {
        if (positions_.meets(positions_of(page))) reaching->push_back(page);
    }
    return std::shared_ptr<const std::vector<PageInfo>>(std::move(reaching));
}

Status Spot::read_page(std::size_t run, const PageInfo& info, const sampledb::ColumnSet& columns, sampledb::PageDecoder& decoder,
                       sampledb::Page& page) const {
    if (Status s = all_.read_page(run, info, columns, decoder, page); !s) return s;
    if (positions_.holds(positions_of(info))) return {};
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < page.count; ++row) {
        if (positions_.holds(page.u[row], page.v[row])) rows.push_back(row);
    }
    if (rows.size() < page.count) sampledb::keep_rows(rows, page);
    return {};
}

}  // namespace latent::develop
