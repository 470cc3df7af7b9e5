#include "sampledb/codec/page_filter.h"

#include <algorithm>

namespace latent::sampledb {

void keep_samples(const Coverage& coverage, Page& page) {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < page.count; ++i) {
        if (coverage.contains(page.sample[i])) rows.push_back(i);
    }
    const auto keep = [&](auto& column) {
        if (column.empty()) return;
        for (std::size_t i = 0; i < rows.size(); ++i) column[i] = column[rows[i]];
    };
    if (!page.pairs.empty()) {
        std::uint32_t at = 0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const std::uint32_t from = page.first_pair[rows[i]];
            page.first_pair[i] = at;
            for (std::uint16_t pair = 0; pair < page.pairs[rows[i]]; ++pair, ++at) {
                page.power[at] = page.power[from + pair];
                if (!page.lambda_nm.empty()) page.lambda_nm[at] = page.lambda_nm[from + pair];
            }
        }
        std::fill(page.first_pair.begin() + static_cast<std::ptrdiff_t>(rows.size()), page.first_pair.end(), at);
    }
    keep(page.sample), keep(page.u), keep(page.v), keep(page.share), keep(page.x), keep(page.y), keep(page.z);
    keep(page.pairs), keep(page.xi), keep(page.index);
    for (ExtraColumn& column : page.extra) {
        const std::size_t bytes = width(column.type);
        for (std::size_t i = 0; i < rows.size() && !column.values.empty(); ++i) {
            std::copy_n(column.values.begin() + static_cast<std::ptrdiff_t>(rows[i] * bytes), bytes,
                        column.values.begin() + static_cast<std::ptrdiff_t>(i * bytes));
        }
    }
    page.count = rows.size();
}

}  // namespace latent::sampledb
