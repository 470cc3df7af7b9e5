// tools/merge/compact_rows.h: rows of many decoded pages, put together into one page.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sampledb/data/job.h"
#include "sampledb/data/page.h"

namespace latent::merge {

// A row of a page in a PageTable.
struct RowRef {
    std::uint32_t page, row;
};

// Decoded pages of one job and class. They stay where they are while the table is used.
class PageTable {
 public:
    explicit PageTable(const sampledb::Job& job) : job_(job), columns_(sampledb::kColumnCount + job.extra.size()) {}
    using Pointers = std::vector<const void*>;  // where a column begins in each page

    void clear();
    std::uint32_t add(const sampledb::Page& page);  // its number
    // Fills `page` with rows, in their order. Thread-safe.
    void gather(std::span<const RowRef> rows, sampledb::Page& page) const;

 private:
    void gather_shares(const Pointers& pages, std::span<const RowRef> rows, std::vector<float>& share) const;
    void gather_pairs(const Pointers& pages, std::span<const RowRef> rows, std::span<const std::uint16_t> pairs,
                      std::vector<float>& to) const;

    const sampledb::Job& job_;
    sampledb::RecordClass record_class_ = sampledb::RecordClass::kCamera;
    std::vector<Pointers> columns_;                 // the extra ones behind the others
    std::vector<const std::uint32_t*> first_pair_;  // each page's
    std::vector<bool> unit_share_;
};

}  // namespace latent::merge
