#include "sampledb/codec/page_filter.h"

#include <algorithm>

namespace latent::sampledb {

void keep_samples(const Coverage& coverage, Page& page) {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < page.count; ++i) {
        if (coverage.contains(page.sample[i])) rows.push_back(i);
    }
    keep_rows(rows, page);
}

void keep_rows(std::span<const std::size_t> rows, Page& page) {
    const auto keep = [&](Shape shape, auto& values) {
        if (values.empty()) return;
        const auto from = values;
        auto* to = values.data();
        for (const std::size_t row : rows) {
            if (shape.rows == Rows::kRecords) {
                copy_row(from.data(), row, shape.width, to);
                to += shape.width;
            } else {
                const std::size_t first = page.first_pair[row], count = page.first_pair[row + 1] - first;
                to = std::copy_n(from.data() + first, count, to);
            }
        }
    };
    for_each_values(keep, page);
    if (!page.first_pair.empty()) {
        std::uint32_t at = 0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            page.first_pair[i] = at;
            at += page.pairs[i];  // those of row i, by now
        }
        std::fill(page.first_pair.begin() + static_cast<std::ptrdiff_t>(rows.size()), page.first_pair.end(), at);
    }
    page.count = rows.size();
}

}  // namespace latent::sampledb
