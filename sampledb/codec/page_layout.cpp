#include "sampledb/codec/page_layout.h"

#include "base/hash.h"
#include "sampledb/data/unreadable.h"

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

Status read_table(const Job& job, const PageInfo& info, ByteSpan stored, std::vector<ColumnEntry>& table) {
    const std::vector<Column> expected = columns_of(job, info.record_class);
    ByteReader in(stored);
    if (in.get<std::uint32_t>() != expected.size()) return corrupt("a page of other columns");
    table.clear();
    for (const Column column : expected) {
        ColumnEntry entry{.column = Column{in.get<std::uint8_t>()}};
        entry.transform = Transform{in.get<std::uint8_t>()};
        entry.bits = in.get<std::uint8_t>();
        const std::uint8_t plane_count = in.get<std::uint8_t>();
        const std::uint32_t lattice_bits = in.get<std::uint32_t>();
        entry.base = in.get<std::uint64_t>();
        entry.hash = in.get<std::uint64_t>();
        if (entry.column != column || plane_count > kMaxPlanes || lattice_bits > 32 || entry.bits > 64) {
            return corrupt("a page's table of columns is invalid");
        }
        entry.lattice_bits = static_cast<std::uint8_t>(lattice_bits);
        for (std::uint8_t p = 0; p < plane_count; ++p) entry.planes.push_back(PlaneEntry::from_word(in.get<std::uint32_t>()));
        table.push_back(std::move(entry));
    }
    for (ColumnEntry& entry : table) {
        std::size_t size = 0;
        for (const PlaneEntry& plane : entry.planes) size += plane.stored_size;
        entry.stored = in.take(size);
    }
    if (!in.ok() || in.remaining() != 0) return corrupt("a page's columns do not fill it");
    if (content_hash(table) != info.content_hash) return corrupt("content hash mismatch");
    return {};
}

}  // namespace latent::sampledb
