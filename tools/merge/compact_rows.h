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
    explicit PageTable(const sampledb::Job& job) : job_(job), extra_(job.extra.size()) {}
    void clear();
    std::uint32_t add(const sampledb::Page& page);  // its number
    // Fills `page` with rows, in their order. Thread-safe.
    void gather(std::span<const RowRef> rows, sampledb::Page& page) const;

 private:
    struct Pairs {
        const std::uint32_t* first;
        const float* power;
        const float* lambda_nm;  // null: derived
    };

    const sampledb::Job& job_;
    sampledb::RecordClass record_class_ = sampledb::RecordClass::kCamera;
    // Where the columns of each page begin.
    std::vector<const std::uint64_t*> sample_;
    std::vector<const std::uint32_t*> u_, v_, xi_;
    std::vector<const float*> share_, x_, y_, z_;  // a share is null where all are 1
    std::vector<const std::uint16_t*> counts_, index_;
    std::vector<Pairs> pairs_;
    std::vector<std::vector<const std::byte*>> extra_;
};

}  // namespace latent::merge
