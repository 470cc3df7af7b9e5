#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/hash.h"
#include "sampledb/file_format.h"
#include "sampledb/page_codec.h"
#include "sampledb/page_layout.h"

namespace latent::sampledb {

namespace {

// Buffers that every page of a thread uses again.
struct Scratch {
    std::array<Bytes, kMaxPlanes> plane;
    std::vector<std::uint32_t> words;
    std::vector<ColumnEntry> table;
};
thread_local Scratch scratch;

std::uint32_t unzigzag(std::uint32_t coded) { return coded >> 1 ^ (0u - (coded & 1)); }

Error corrupt(std::string what) { return {ErrorCode::kCorrupt, std::move(what)}; }

// Reads the table into scratch.table and finds each column's stored bytes.
Status read_table(const Job& job, const PageInfo& info, ByteSpan stored) {
    const std::vector<Column> expected = columns_of(job, info.record_class);
    ByteReader in(stored);
    if (in.get<std::uint32_t>() != expected.size()) return corrupt("a page of other columns");
    scratch.table.clear();
    for (const Column column : expected) {
        ColumnEntry entry{.column = Column{in.get<std::uint8_t>()}};
        entry.transform = Transform{in.get<std::uint8_t>()};
        entry.bits = in.get<std::uint8_t>();
        const std::uint8_t plane_count = in.get<std::uint8_t>();
        const std::uint32_t lattice_bits = in.get<std::uint32_t>();
        entry.base = in.get<std::uint64_t>();
        entry.hash = in.get<std::uint64_t>();
        if (entry.column != column || plane_count > kMaxPlanes || lattice_bits > 32 || entry.bits > 64) {
            return corrupt("a page's table of columns makes no sense");
        }
        entry.lattice_bits = static_cast<std::uint8_t>(lattice_bits);
        for (std::uint8_t p = 0; p < plane_count; ++p) entry.planes.push_back(PlaneEntry::from_word(in.get<std::uint32_t>()));
        scratch.table.push_back(std::move(entry));
    }
    for (ColumnEntry& entry : scratch.table) {
        std::size_t size = 0;
        for (const PlaneEntry& plane : entry.planes) size += plane.stored_size;
        entry.stored = in.take(size);
    }
    if (!in.ok() || in.remaining() != 0) return corrupt("a page's columns do not fill it");
    if (content_hash(scratch.table) != info.content_hash) return corrupt("content hash mismatch");
    return {};
}

// Joins a column's byte planes into `values`.
Status load_planes(const ColumnEntry& entry, std::span<std::byte> values, std::size_t value_width) {
    if (entry.planes.size() != value_width) return corrupt("a column with planes missing");
    std::array<ByteSpan, kMaxPlanes> planes;
    ByteSpan stored = entry.stored;
    for (std::size_t p = 0; p < value_width; ++p) {
        const PlaneEntry& plane = entry.planes[p];
        const Result<ByteSpan> bytes =
            decode_plane(plane, stored.first(plane.stored_size), values.size() / value_width, scratch.plane[p]);
        if (!bytes) return bytes.error();
        planes[p] = *bytes;
        stored = stored.subspan(plane.stored_size);
    }
    join_planes(std::span(planes).first(value_width), values);
    return {};
}

Status load_packed(const ColumnEntry& entry, std::span<std::uint64_t> values) {
    if (entry.bits == 0) {
        std::ranges::fill(values, 0);
        return entry.planes.empty() ? Status{} : corrupt("a constant column with planes");
    }
    if (entry.planes.size() != 1) return corrupt("a packed column of several planes");
    const Result<ByteSpan> packed =
        decode_plane(entry.planes[0], entry.stored, packed_size(values.size(), entry.bits), scratch.plane[0]);
    if (!packed) return packed.error();
    unpack_bits(*packed, entry.bits, values);
    return {};
}

Status unknown_transform(const ColumnEntry& entry) {
    return Error{ErrorCode::kUnsupported, fmt::format("column {}: transform {} is not known here", static_cast<int>(entry.column),
                                                      static_cast<int>(entry.transform))};
}

// Columns that are planes, or constant.
Status decode_plain(const ColumnEntry& entry, std::span<std::byte> values, std::size_t value_width) {
    if (values.empty()) return {};
    if (entry.transform == Transform::kPlanes) return load_planes(entry, values, value_width);
    if (entry.transform != Transform::kPacked || entry.bits != 0 || !entry.planes.empty()) return unknown_transform(entry);
    for (std::size_t at = 0; at < values.size(); at += value_width) std::memcpy(&values[at], &entry.base, value_width);
    return {};
}

Status decode_samples(const ColumnEntry& entry, std::span<std::uint64_t> n) {
    if (entry.transform != Transform::kPacked && entry.transform != Transform::kLattice) return unknown_transform(entry);
    if (Status s = load_packed(entry, n); !s) return s;
    if (entry.transform == Transform::kPacked) {
        for (std::uint64_t& value : n) value += entry.base;
        return {};
    }
    const unsigned s = entry.lattice_bits;
    if (s == 0) return corrupt("a lattice of no bits");
    const std::uint64_t mask = (std::uint64_t{1} << s) - 1;
    const std::uint64_t high = entry.base & ~mask;
    const std::uint32_t f0 = reverse_bits(static_cast<std::uint32_t>(entry.base & mask));  // in its s high bits
    for (std::uint64_t& value : n) value = high | reverse_bits(f0 + static_cast<std::uint32_t>(value << (32 - s)));
    return {};
}

Status decode_crossed(const ColumnEntry& entry, std::span<float> values, std::span<const float> y) {
    const std::span<std::byte> bytes = std::as_writable_bytes(values);
    if (entry.transform != Transform::kCross) return decode_plain(entry, bytes, 4);
    const std::span<std::uint32_t> words = at_least(scratch.words, values.size());
    if (Status s = load_planes(entry, std::as_writable_bytes(words), 4); !s) return s;
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(y[i]) + unzigzag(words[i]));
    }
    return {};
}

Status decode_delta2(const ColumnEntry& entry, std::span<float> values, std::span<const std::uint16_t> pairs) {
    const std::span<std::byte> bytes = std::as_writable_bytes(values);
    if (entry.transform != Transform::kDelta2) return decode_plain(entry, bytes, 4);
    const std::span<std::uint32_t> words = at_least(scratch.words, values.size());
    if (Status s = load_planes(entry, std::as_writable_bytes(words), 4); !s) return s;
    std::size_t at = 0;
    for (const std::uint16_t n : pairs) {
        if (n == 0) continue;
        std::uint32_t before = words[at], slope = 0;
        values[at++] = std::bit_cast<float>(before);
        for (std::uint16_t i = 1; i < n; ++i, ++at) {
            slope += unzigzag(words[at]);
            before += slope;
            values[at] = std::bit_cast<float>(before);
        }
    }
    return {};
}

// Pairs, and where each record's begin. The counts are believed only once they add up.
Status decode_pairs(const Job& job, const ColumnEntry& entry, const PageInfo& info, Page& page) {
    const std::span<std::uint16_t> pairs = at_least(page.pairs, page.count + Page::kPadding).first(page.count);
    if (Status s = decode_plain(entry, std::as_writable_bytes(pairs), 2); !s) return s;
    const std::span<std::uint32_t> first = at_least(page.first_pair, page.count + Page::kPadding);
    const bool whole_batches = !job.density.empty();
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < page.count; ++i) {
        first[i] = static_cast<std::uint32_t>(sum);
        if (pairs[i] > job.batch || (whole_batches && pairs[i] > 1 && pairs[i] != job.batch))
            return corrupt("a record of too many pairs");
        sum += pairs[i];
    }
    std::fill(first.begin() + static_cast<std::ptrdiff_t>(page.count), first.end(), static_cast<std::uint32_t>(sum));
    return sum == info.pair_count ? Status{} : corrupt("the pairs of a page do not add up");
}

Status check_index(const Job& job, const Page& page) {
    for (std::size_t i = 0; i < page.count; ++i) {
        const bool kept_alone = page.pairs[i] == 1 && job.batch > 1;
        if (kept_alone ? page.index[i] >= job.batch : page.index[i] != kNoIndex) return corrupt("a wavelength outside its batch");
    }
    return {};
}

}  // namespace

Status decode_page(const Job& job, const PageInfo& info, ByteSpan stored, const ColumnSet& columns, Page& page, bool every_column) {
    if (stored.size() != info.stored_size) return Error{ErrorCode::kTruncated, "the page ends early"};
    if (hash64(stored) != info.stored_hash) return corrupt("checksum mismatch");
    if (Status s = read_table(job, info, stored); !s) return s;

    page.record_class = info.record_class;
    page.count = info.record_count;
    const std::size_t count = page.count;
    const std::size_t pair_count = info.pair_count;
    const ColumnEntry* next = scratch.table.data();
    const auto prepare = [](auto& column, std::size_t size) { return at_least(column, size + Page::kPadding).first(size); };
    const auto check = [&](const ColumnEntry& entry, ByteSpan values) {
        return (every_column || entry.transform == Transform::kSampler) && hash64(values) != entry.hash
                   ? Status(corrupt(fmt::format("column {} does not decode to its content hash", static_cast<int>(entry.column))))
                   : Status{};
    };
    const auto plain = [&](auto& column, bool wanted, const ColumnEntry& entry) -> Status {
        if (!wanted) {
            column.clear();
            return {};
        }
        const auto values = prepare(column, count);
        if (Status s = decode_plain(entry, std::as_writable_bytes(values), sizeof(values[0])); !s) return s;
        return check(entry, std::as_bytes(values));
    };

    const ColumnEntry& sample = *next++;
    const ColumnEntry& u = *next++;
    const ColumnEntry& v = *next++;
    const bool derived = u.transform == Transform::kSampler;
    if (derived != (v.transform == Transform::kSampler)) return corrupt("half a position");
    if (derived && job.positions.sampler == PositionSampler::kNone) return corrupt("positions left out in a job without a sampler");
    if (columns.samples || (columns.positions && derived)) {
        const std::span<std::uint64_t> n = prepare(page.sample, count);
        if (Status s = decode_samples(sample, n); !s) return s;
        if (Status s = check(sample, std::as_bytes(n)); !s) return s;
    } else {
        page.sample.clear();
    }
    if (columns.positions && derived) {
        const std::span<std::uint32_t> du = prepare(page.u, count), dv = prepare(page.v, count);
        halton23(rows(page.sample, count), job.positions, du, dv);
        if (Status s = check(u, std::as_bytes(du)); !s) return s;
        if (Status s = check(v, std::as_bytes(dv)); !s) return s;
    } else {
        if (Status s = plain(page.u, columns.positions, u); !s) return s;
        if (Status s = plain(page.v, columns.positions, v); !s) return s;
    }

    page.unit_share = false;
    if (info.record_class == RecordClass::kCamera) {
        const ColumnEntry& share = *next++;
        page.unit_share =
            share.transform == Transform::kPacked && share.bits == 0 && share.base == std::bit_cast<std::uint32_t>(1.0f);
        if (Status s = plain(page.share, columns.share && !page.unit_share, share); !s) return s;
    } else {
        page.share.clear();
    }

    if (job.kind == RecordKind::kXyz) {
        const ColumnEntry& x = *next++;
        const ColumnEntry& y = *next++;
        const ColumnEntry& z = *next++;
        if (Status s = plain(page.y, columns.values, y); !s) return s;
        if (!columns.values) page.x.clear(), page.z.clear();
        if (columns.values) {
            const std::span<float> px = prepare(page.x, count), pz = prepare(page.z, count);
            if (Status s = decode_crossed(x, px, rows(page.y, count)); !s) return s;
            if (Status s = decode_crossed(z, pz, rows(page.y, count)); !s) return s;
            if (Status s = check(x, std::as_bytes(px)); !s) return s;
            if (Status s = check(z, std::as_bytes(pz)); !s) return s;
        }
    } else {
        const ColumnEntry& pairs = *next++;
        const auto spectral = [&](std::vector<float>& column, const ColumnEntry& entry) -> Status {
            const std::span<float> values = prepare(column, pair_count);
            if (Status s = decode_delta2(entry, values, rows(page.pairs, count)); !s) return s;
            return check(entry, std::as_bytes(values));
        };
        if (!columns.values) {
            page.pairs.clear(), page.first_pair.clear(), page.xi.clear(), page.index.clear(), page.power.clear(),
                page.lambda_nm.clear();
            next += job.density.empty() ? 2 : 3;
        } else {
            if (Status s = decode_pairs(job, pairs, info, page); !s) return s;
            if (Status s = check(pairs, std::as_bytes(rows(page.pairs, count))); !s) return s;
            if (!job.density.empty()) {
                if (Status s = plain(page.xi, true, *next++); !s) return s;
                if (Status s = plain(page.index, true, *next++); !s) return s;
                if (Status s = check_index(job, page); !s) return s;
            }
            if (Status s = spectral(page.power, *next++); !s) return s;
            if (job.density.empty()) {
                if (Status s = spectral(page.lambda_nm, *next++); !s) return s;
            }
        }
    }

    page.extra.resize(job.extra.size());
    for (std::size_t i = 0; i < job.extra.size(); ++i) {
        const ColumnEntry& entry = *next++;
        ExtraColumn& column = page.extra[i];
        column.name = job.extra[i].name;
        column.type = job.extra[i].type;
        if (!columns.extra) {
            column.values.clear();
            continue;
        }
        const std::size_t value_width = width(column.type);
        const std::span<std::byte> values =
            at_least(column.values, (count + Page::kPadding) * value_width).first(count * value_width);
        if (Status s = decode_plain(entry, values, value_width); !s) return s;
        if (Status s = check(entry, values); !s) return s;
    }
    return {};
}

Result<std::vector<StoredColumn>> stored_columns(const Job& job, const PageInfo& info, ByteSpan stored) {
    if (Status s = read_table(job, info, stored); !s) return s.error();
    const std::uint64_t values = info.pair_count, rows_of_page = info.record_count;
    static constexpr struct {
        Column column;
        const char* name;
        unsigned width;
    } kNames[] = {{Column::kSample, "sample", 8}, {Column::kU, "u", 4},         {Column::kV, "v", 4},
                  {Column::kShare, "share", 4},   {Column::kX, "x", 4},         {Column::kY, "y", 4},
                  {Column::kZ, "z", 4},           {Column::kPairs, "pairs", 2}, {Column::kXi, "xi", 4},
                  {Column::kIndex, "index", 2},   {Column::kPower, "power", 4}, {Column::kLambda, "lambda", 4}};
    std::vector<StoredColumn> columns;
    for (const ColumnEntry& entry : scratch.table) {
        const std::uint64_t bytes = kColumnEntrySize + 4 * entry.planes.size() + entry.stored.size();
        if (entry.column >= Column::kFirstExtra) {
            const ExtraColumnSpec& extra =
                job.extra[static_cast<std::size_t>(entry.column) - static_cast<std::size_t>(Column::kFirstExtra)];
            columns.push_back({extra.name, bytes, rows_of_page * width(extra.type)});
            continue;
        }
        const auto* const name = std::ranges::find(kNames, entry.column, [](const auto& known) { return known.column; });
        const bool of_pairs = entry.column == Column::kPower || entry.column == Column::kLambda;
        columns.push_back({name->name, bytes, (of_pairs ? values : rows_of_page) * name->width});
    }
    return columns;
}

}  // namespace latent::sampledb
