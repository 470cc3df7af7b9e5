#include "sampledb/codec/page_layout.h"

#include "base/hash.h"

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

}  // namespace latent::sampledb
