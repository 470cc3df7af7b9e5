#include "sampledb/data/page.h"

#include <algorithm>

#include "sampledb/data/limits.h"

namespace latent::sampledb {

std::size_t max_page_records(const Job& job) {
    constexpr std::size_t kMost = kMaxRecordsPerPage, kLeast = 64;
    static_assert(kLeast * kMaxPairs <= kMaxPairsPerPage);
    return job.kind == RecordKind::kXyz ? kMost : std::clamp<std::size_t>(kMaxPairsPerPage / job.batch, kLeast, kMost);
}

std::uint64_t decoded_page_size(const Job& job, RecordClass record_class, std::uint64_t records, std::uint64_t pairs) {
    std::uint64_t row = 8 + 4 + 4;
    std::uint64_t pair = 0;
    if (record_class == RecordClass::kCamera) row += 4;
    if (job.kind == RecordKind::kXyz) {
        row += 12;
    } else {
        row += job.density.empty() ? 2 : 2 + 4 + 2;
        pair = job.density.empty() ? 8 : 4;
    }
    for (const ExtraColumnSpec& column : job.extra) row += width(column.type);
    return records * row + pairs * pair;
}

}  // namespace latent::sampledb
