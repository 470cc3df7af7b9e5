#include "sampledb/codec/page_layout.h"

#include "base/hash.h"
#include "sampledb/data/limits.h"
#include "sampledb/data/unreadable.h"

namespace latent::sampledb {

std::uint64_t content_hash(const std::vector<ColumnEntry>& table) {
    std::array<std::uint64_t, kColumnCount + kMaxExtraColumns> hashes;
    assert(table.size() <= hashes.size());
    for (std::size_t i = 0; i < table.size(); ++i) hashes[i] = table[i].hash;
    return hash64(std::as_bytes(std::span(hashes).first(table.size())));
}

namespace {

// Reads the entry of column `number`; false if it is another's, or impossible.
bool read_entry(ByteReader& in, Column number, ColumnEntry& entry) {
    entry.column = Column{in.get<std::uint8_t>()};
    entry.transform = Transform{in.get<std::uint8_t>()};
    entry.bits = in.get<std::uint8_t>();
    const std::uint8_t plane_count = in.get<std::uint8_t>();
    const std::uint32_t lattice_bits = in.get<std::uint32_t>();
    entry.base = in.get<std::uint64_t>();
    entry.hash = in.get<std::uint64_t>();
    if (entry.column != number || plane_count > kMaxPlanes || lattice_bits > 32 || entry.bits > 64) return false;
    entry.lattice_bits = static_cast<std::uint8_t>(lattice_bits);
    entry.planes.clear();
    for (std::uint8_t p = 0; p < plane_count; ++p) entry.planes.push_back(PlaneEntry::from_word(in.get<std::uint32_t>()));
    return true;
}

}  // namespace

Status read_table(const Job& job, const PageInfo& info, ByteSpan stored, std::vector<ColumnEntry>& table) {
    std::size_t count = job.extra.size();
    for_each_column([&](auto column) { count += has_column(job, info.record_class, column.spec.presence) ? 1 : 0; });
    ByteReader in(stored);
    if (in.get<std::uint32_t>() != count) return corrupt("a page with other columns than its job has");
    table.resize(count);
    bool valid = true;
    auto entry = table.begin();
    for_each_column([&](auto column) {
        if (has_column(job, info.record_class, column.spec.presence)) valid = valid && read_entry(in, column.spec.number, *entry++);
    });
    for (std::size_t i = 0; i < job.extra.size(); ++i) valid = valid && read_entry(in, extra_number(i), *entry++);
    if (!valid) return corrupt("a page's table of columns is invalid");
    for (ColumnEntry& column : table) {
        std::size_t size = 0;
        for (const PlaneEntry& plane : column.planes) size += plane.stored_size;
        column.stored = in.take(size);
    }
    if (!in.ok() || in.remaining() != 0) return corrupt("a page's columns do not fill it");
    if (content_hash(table) != info.content_hash) return corrupt("content hash mismatch");
    return {};
}

}  // namespace latent::sampledb
