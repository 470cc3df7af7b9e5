#include "sampledb/codec/page_layout.h"

#include <algorithm>

#include "base/hash.h"
#include "sampledb/codec/page_codec.h"
#include "sampledb/format/file_format.h"

namespace latent::sampledb {

std::vector<Column> columns_of(const Job& job, RecordClass record_class) {
    std::vector<Column> columns = {Column::kSample, Column::kU, Column::kV};
    if (record_class == RecordClass::kCamera) columns.push_back(Column::kShare);
    if (job.kind == RecordKind::kXyz) {
        columns.insert(columns.end(), {Column::kX, Column::kY, Column::kZ});
    } else if (job.density.empty()) {
        columns.insert(columns.end(), {Column::kPairs, Column::kPower, Column::kLambda});
    } else {
        columns.insert(columns.end(), {Column::kPairs, Column::kXi, Column::kIndex, Column::kPower});
    }
    for (std::size_t i = 0; i < job.extra.size(); ++i) {
        columns.push_back(static_cast<Column>(static_cast<std::size_t>(Column::kFirstExtra) + i));
    }
    return columns;
}

std::uint64_t content_hash(const std::vector<ColumnEntry>& table) {
    std::array<std::uint64_t, 32> hashes;
    assert(table.size() <= hashes.size());
    for (std::size_t i = 0; i < table.size(); ++i) hashes[i] = table[i].hash;
    return hash64(std::as_bytes(std::span(hashes).first(table.size())));
}

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
