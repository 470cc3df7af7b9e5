// c_api/records.h: columns of latent.h to columns of the library, and back.
#pragma once

#include <cstdint>
#include <vector>

#include "base/result.h"
#include "c_api/latent.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"
#include "sampledb/data/record.h"

namespace latent::c {

// A copy. Errors: kUsage (a column that the job needs is null), kOutOfRange (pair_count is not the sum of pairs).
Result<sampledb::Records> records_from(const sampledb::Job& job, const latent_records* records);

// What is read, as the caller sees it: the page's columns, and those that are derived from them.
class RecordView {
 public:
    // `columns`: those to show, LATENT_SAMPLES .. LATENT_EXTRA. The view is good until the page or this object changes.
    latent_records of(const sampledb::Job& job, const sampledb::Page& page, std::uint32_t columns);

 private:
    void derive_wavelengths(const sampledb::Job& job, const sampledb::Page& page, std::size_t pairs);

    std::vector<std::uint8_t> classes_;
    std::vector<float> shares_, lambda_nm_;
    std::vector<const void*> extra_;
};

}  // namespace latent::c
