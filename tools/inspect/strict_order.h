// tools/inspect/strict_order.h: are the records of a run in order, its pages cut as they should be, their squares the smallest?
// docs/format.md, "Order" and "Pages".
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "sampledb/data/page.h"
#include "tools/inspect/violation.h"

namespace latent::inspect {

class OrderCheck {
 public:
    // Checks run `number`; what is wrong joins `violations`.
    OrderCheck(const sampledb::Job& job, std::size_t number, Violations& violations);

    void add(const sampledb::PageInfo& info, std::size_t number, const sampledb::Page& page);  // the next page, decoded
    void finish();

 private:
    struct Cut {
        std::size_t page, records;
    };

    void check_square(const sampledb::PageInfo& info, std::size_t number, const sampledb::Page& page);
    void check_order(std::size_t number, const sampledb::Page& page);
    void check_cuts(std::size_t keep);
    void finish_class();

    const std::size_t page_records_, run_;
    Violations& violations_;
    sampledb::RecordClass record_class_ = sampledb::RecordClass::kCamera;
    bool any_ = false;  // records of this class so far
    std::uint32_t last_z_ = 0;
    std::uint64_t last_sample_ = 0;
    bool in_order_ = true;  // Z prefixes of this class: without that the cut has no meaning
    std::vector<std::uint32_t>
        z_;  // positions in pages whose cut is not checked, behind `lead_` record (0 or 1) that ends the one before
    std::size_t lead_ = 0;
    std::deque<Cut> cuts_;
};

}  // namespace latent::inspect
