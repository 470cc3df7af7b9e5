#include "tools/merge/compact_rows.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace latent::merge {

using namespace sampledb;

namespace {

template <class T>
void gather_column(const PageTable::Pointers& pages, std::span<const RowRef> rows, std::size_t width, std::vector<T>& to) {
    to.resize(rows.size() * width);
    for (std::size_t i = 0; i < rows.size(); ++i)
        copy_row(static_cast<const T*>(pages[rows[i].page]), rows[i].row, width, &to[i * width]);
}

}  // namespace

void PageTable::clear() {
    for (auto& column : columns_) column.clear();
    first_pair_.clear();
    unit_share_.clear();
}

std::uint32_t PageTable::add(const Page& page) {
    record_class_ = page.record_class;
    auto column = columns_.begin();
    for_each_values([&](Shape, const auto& values) { (column++)->push_back(values.data()); }, page);
    first_pair_.push_back(page.first_pair.data());
    unit_share_.push_back(page.unit_share);
    return static_cast<std::uint32_t>(first_pair_.size() - 1);
}

void PageTable::gather_shares(const Pointers& pages, std::span<const RowRef> rows, std::vector<float>& share) const {
    for (const RowRef& row : rows)
        share.push_back(unit_share_[row.page] ? 1.0f : static_cast<const float*>(pages[row.page])[row.row]);
}

void PageTable::gather_pairs(const Pointers& pages, std::span<const RowRef> rows, std::span<const std::uint16_t> pairs,
                             std::vector<float>& to) const {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const float* const from = static_cast<const float*>(pages[rows[i].page]) + first_pair_[rows[i].page][rows[i].row];
        to.insert(to.end(), from, from + pairs[i]);
    }
}

void PageTable::gather(std::span<const RowRef> rows, Page& page) const {
    page.record_class = record_class_;
    page.count = rows.size();
    for_each_column([&](auto column) {
        constexpr auto spec = column.spec;
        auto& to = page.*spec.values;
        to.clear();
        if (!has_column(job_, record_class_, spec.presence)) return;
        if constexpr (spec.number == Column::kShare) {
            gather_shares(columns_[column.place], rows, to);
        } else if constexpr (spec.rows == Rows::kPairs) {
            gather_pairs(columns_[column.place], rows, page.pairs, to);
        } else {
            gather_column(columns_[column.place], rows, 1, to);
        }
    });
    if (page.extra.size() != job_.extra.size()) page.extra = extra_columns(job_);
    for (std::size_t i = 0; i < page.extra.size(); ++i)
        gather_column(columns_[kColumnCount + i], rows, width(page.extra[i].type), page.extra[i].values);
    page.unit_share = std::ranges::all_of(page.share, [](float share) { return share == 1; });
    page.first_pair.assign(page.pairs.empty() ? 0 : rows.size() + 1, 0);
    if (!page.pairs.empty())
        std::inclusive_scan(page.pairs.begin(), page.pairs.end(), page.first_pair.begin() + 1, std::plus<>(), std::uint32_t{0});
}

}  // namespace latent::merge
