#include "tools/merge/compact_rows.h"

#include <algorithm>

namespace latent::merge {

using namespace sampledb;

namespace {

template <class T>
void gather_column(const std::vector<const T*>& from, std::span<const RowRef> rows, std::vector<T>& to) {
    to.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) to[i] = from[rows[i].page][rows[i].row];
}

template <class T>
void append(std::vector<T>& to, const T* from, std::size_t count) {
    to.insert(to.end(), from, from + count);
}

}  // namespace

void PageTable::clear() {
    for (auto* column : {&u_, &v_, &xi_}) column->clear();
    for (auto* column : {&share_, &x_, &y_, &z_}) column->clear();
    for (auto* column : {&counts_, &index_}) column->clear();
    for (auto& column : extra_) column.clear();
    sample_.clear();
    pairs_.clear();
}

std::uint32_t PageTable::add(const Page& page) {
    record_class_ = page.record_class;
    sample_.push_back(page.sample.data());
    u_.push_back(page.u.data());
    v_.push_back(page.v.data());
    share_.push_back(page.share.empty() ? nullptr : page.share.data());
    x_.push_back(page.x.data());
    y_.push_back(page.y.data());
    z_.push_back(page.z.data());
    counts_.push_back(page.pairs.data());
    xi_.push_back(page.xi.data());
    index_.push_back(page.index.data());
    pairs_.push_back({page.first_pair.data(), page.power.data(), page.lambda_nm.empty() ? nullptr : page.lambda_nm.data()});
    for (std::size_t i = 0; i < extra_.size(); ++i) extra_[i].push_back(page.extra[i].values.data());
    return static_cast<std::uint32_t>(sample_.size() - 1);
}

void PageTable::gather(std::span<const RowRef> rows, Page& page) const {
    page.record_class = record_class_;
    page.count = rows.size();
    gather_column(sample_, rows, page.sample);
    gather_column(u_, rows, page.u);
    gather_column(v_, rows, page.v);
    page.share.clear();
    page.unit_share = true;
    if (record_class_ == RecordClass::kCamera) {
        for (const RowRef& row : rows) page.share.push_back(share_[row.page] ? share_[row.page][row.row] : 1.0f);
        page.unit_share = std::ranges::all_of(page.share, [](float share) { return share == 1; });
    }
    if (job_.kind == RecordKind::kXyz) {
        gather_column(x_, rows, page.x);
        gather_column(y_, rows, page.y);
        gather_column(z_, rows, page.z);
    } else {
        gather_column(counts_, rows, page.pairs);
        page.power.clear(), page.lambda_nm.clear(), page.first_pair.clear();
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const Pairs& from = pairs_[rows[i].page];
            const std::uint32_t first = from.first[rows[i].row];
            page.first_pair.push_back(static_cast<std::uint32_t>(page.power.size()));
            append(page.power, from.power + first, page.pairs[i]);
            if (from.lambda_nm) append(page.lambda_nm, from.lambda_nm + first, page.pairs[i]);
        }
        if (!job_.density.empty()) {
            gather_column(xi_, rows, page.xi);
            gather_column(index_, rows, page.index);
        }
    }
    page.extra.resize(extra_.size());
    for (std::size_t c = 0; c < extra_.size(); ++c) {
        const std::size_t bytes = width(job_.extra[c].type);
        std::vector<std::byte>& to = page.extra[c].values;
        to.resize(rows.size() * bytes);
        for (std::size_t i = 0; i < rows.size(); ++i)
            std::copy_n(extra_[c][rows[i].page] + rows[i].row * bytes, bytes, &to[i * bytes]);
    }
}

}  // namespace latent::merge
