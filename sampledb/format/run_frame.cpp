#include <fmt/format.h>

#include <algorithm>

#include "sampledb/data/z_order.h"
#include "sampledb/format/file_format.h"
#include "sampledb/format/frames.h"

namespace latent::sampledb {

namespace {

constexpr std::size_t kPageContentSize = 32;  // the part of a page's entry that is a function of its records

void put_page_content(ByteWriter& out, const PageInfo& page) {
    out.put(page.node.level);
    out.put(static_cast<std::uint8_t>(page.record_class));
    out.put(std::uint16_t{0});
    out.put(page.node.x);
    out.put(page.node.y);
    out.put(page.record_count);
    out.put(page.pair_count);
    out.put(page.decoded_size);
    out.put(page.content_hash);
}

// Hash over what all entries say of their records; `entries` are kPageEntrySize bytes each.
Hash128 content_hash(ByteSpan entries) {
    Hasher128 hasher;
    for (std::size_t at = 0; at < entries.size(); at += kPageEntrySize) hasher.update(entries.subspan(at, kPageContentSize));
    return hasher.digest();
}

Result<PageInfo> get_page_entry(ByteReader& in, const Job& job) {
    PageInfo page;
    page.node.level = in.get<std::uint8_t>();
    const std::uint8_t record_class = in.get<std::uint8_t>();
    std::uint64_t reserved = in.get<std::uint16_t>();
    page.node.x = in.get<std::uint32_t>();
    page.node.y = in.get<std::uint32_t>();
    page.record_count = in.get<std::uint32_t>();
    page.pair_count = in.get<std::uint32_t>();
    page.decoded_size = in.get<std::uint32_t>();
    page.content_hash = in.get<std::uint64_t>();
    page.stored_size = in.get<std::uint32_t>();
    reserved |= in.get<std::uint32_t>();
    page.stored_hash = in.get<std::uint64_t>();
    if (record_class > 1 || reserved != 0) return corrupt("a page of unknown class");
    page.record_class = RecordClass{record_class};
    if (page.node.level > kZPrefixLevels || page.node.x >> page.node.level != 0 || page.node.y >> page.node.level != 0) {
        return corrupt("a page outside the film");
    }
    if (page.record_count == 0 || page.record_count > max_page_records(job) ||
        page.pair_count > std::uint64_t{page.record_count} * job.batch) {
        return corrupt("a page of more records or pairs than there may be");
    }
    if (page.decoded_size != decoded_page_size(job, page.record_class, page.record_count, page.pair_count) ||
        page.stored_size > page.decoded_size + kMaxStoredOverhead) {
        return corrupt("a page whose size contradicts its records");
    }
    return page;
}

}  // namespace

std::uint64_t RunHeader::index_size() const { return interval_count * kIntervalSize + page_count * kPageEntrySize; }
std::uint64_t RunHeader::size() const { return round_up_to_block(index_offset() + index_size()); }

void put_run_entry(ByteWriter& out, const RunHeader& header) {
    out.put(kMajor);
    out.put(kMinor);
    out.put(header.interval_count);
    out.put(kKnownFeatures);
    put_hash(out, header.job);
    out.put(header.samples.first);
    out.put(header.samples.end);
    out.put(header.sample_count);
    out.put(static_cast<std::uint64_t>(header.page_count));
    out.put(header.camera_records);
    out.put(header.light_records);
    out.put(header.pair_count);
    out.put(header.decoded_size);
    out.put(header.pages_size);
    out.put(header.index_hash);
    put_hash(out, header.content_hash);
}

Bytes encode_run_header(const RunHeader& header) {
    Bytes bytes;
    bytes.reserve(kRunHeaderSize);
    ByteWriter out(bytes);
    out.put(bytes_of(kRunMagic));
    put_run_entry(out, header);
    out.put_zeros(kRunHeaderSize - 8 - bytes.size());
    out.put(hash64(bytes));
    return bytes;
}

Result<RunFrame> decode_run_frame(ByteSpan bytes) {
    if (!begins_with(bytes, kRunMagic)) return Error{ErrorCode::kForeign, "no run begins here"};
    if (bytes.size() < kRunHeaderSize) return Error{ErrorCode::kTruncated, "ends inside a run's header"};
    if (load_le<std::uint64_t>(&bytes[kRunHeaderSize - 8]) != hash64(bytes.first(kRunHeaderSize - 8)))
        return corrupt("run header checksum mismatch");
    const auto field = [&](std::size_t at) { return load_le<std::uint64_t>(&bytes[at]); };
    const std::uint64_t intervals = load_le<std::uint32_t>(&bytes[12]), pages = field(64), pages_size = field(104);
    RunFrame frame{{field(24), field(32)}, {field(40), field(48)}, ~std::uint64_t{0}};  // longer than any file
    if (pages <= std::uint64_t{1} << 48 && pages_size <= std::uint64_t{1} << 62) {
        frame.size = round_up_to_block(kRunHeaderSize + pages_size + intervals * kIntervalSize + pages * kPageEntrySize);
    }
    return frame;
}

Result<RunHeader> decode_run_header(ByteSpan bytes) {
    const Result<RunFrame> frame = decode_run_frame(bytes);
    if (!frame) return frame.error();
    Result<RunHeader> header = decode_run_entry(bytes.subspan(sizeof(Magic), kRunEntrySize));
    const std::size_t reserved = sizeof(Magic) + kRunEntrySize;
    if (header && !all_zero(bytes.subspan(reserved, kRunHeaderSize - 8 - reserved)))
        return corrupt("a run header with unknown fields");
    return header;
}

Result<RunHeader> decode_run_entry(ByteSpan entry) {
    ByteReader in(entry);
    const std::uint16_t major = in.get<std::uint16_t>();
    in.get<std::uint16_t>();  // minor versions add nothing that must be understood
    RunHeader header;
    header.interval_count = in.get<std::uint32_t>();
    const std::uint64_t features = in.get<std::uint64_t>();
    header.job = get_hash(in);
    header.samples.first = in.get<std::uint64_t>();
    header.samples.end = in.get<std::uint64_t>();
    header.sample_count = in.get<std::uint64_t>();
    const std::uint64_t page_count = in.get<std::uint64_t>();
    header.camera_records = in.get<std::uint64_t>();
    header.light_records = in.get<std::uint64_t>();
    header.pair_count = in.get<std::uint64_t>();
    header.decoded_size = in.get<std::uint64_t>();
    header.pages_size = in.get<std::uint64_t>();
    header.index_hash = in.get<std::uint64_t>();
    header.content_hash = get_hash(in);
    if (!in.ok()) return Error{ErrorCode::kTruncated, "ends inside a run's header"};
    if (Status s = check_version(major, features); !s) return s.error();

    const std::uint64_t most_records = page_count * kMaxRecordsPerPage;  // page_count is small: checked first
    if (page_count > kMaxPagesPerRun || header.camera_records > most_records || header.light_records > most_records ||
        header.camera_records + header.light_records > most_records || header.camera_records + header.light_records < page_count ||
        header.pair_count > page_count * kMaxPairsPerPage || header.decoded_size > page_count * kMaxDecodedPage ||
        header.pages_size > header.decoded_size + page_count * kMaxStoredOverhead) {
        return corrupt("a run header whose counts contradict each other");
    }
    header.page_count = static_cast<std::uint32_t>(page_count);
    const std::uint64_t span = header.samples.size();
    if (header.samples.empty() || header.interval_count == 0 || header.interval_count > kMaxIntervalsPerRun ||
        header.sample_count > span || header.sample_count < header.interval_count ||
        (header.interval_count == 1) != (header.sample_count == span)) {
        return corrupt("a run header whose coverage contradicts itself");
    }
    return header;
}

Bytes encode_run_index(const RunIndex& index, RunHeader& header) {
    const std::vector<SampleRange>& ranges = index.coverage.ranges();
    header.samples = {ranges.front().first, ranges.back().end};
    header.sample_count = index.coverage.size();
    header.interval_count = static_cast<std::uint32_t>(ranges.size());
    header.page_count = static_cast<std::uint32_t>(index.pages.size());
    Bytes bytes;
    ByteWriter out(bytes);
    for (const SampleRange& range : ranges) {
        out.put(range.first);
        out.put(range.end);
    }
    header.camera_records = header.light_records = header.pair_count = header.decoded_size = header.pages_size = 0;
    for (const PageInfo& page : index.pages) {
        put_page_content(out, page);
        out.put(page.stored_size);
        out.put(std::uint32_t{0});
        out.put(page.stored_hash);
        (page.record_class == RecordClass::kCamera ? header.camera_records : header.light_records) += page.record_count;
        header.pair_count += page.pair_count;
        header.decoded_size += page.decoded_size;
        header.pages_size += page.stored_size;
    }
    header.content_hash = content_hash(ByteSpan(bytes).subspan(ranges.size() * kIntervalSize));
    out.put_zeros(header.size() - header.index_offset() - bytes.size());
    header.index_hash = hash64(bytes);
    return bytes;
}

Result<RunIndex> decode_run_index(ByteSpan bytes, const RunHeader& header, const Job& job) {
    if (bytes.size() != header.size() - header.index_offset()) return Error{ErrorCode::kTruncated, "ends inside a run's index"};
    if (hash64(bytes) != header.index_hash) return corrupt("run index checksum mismatch");
    const ByteSpan entries = bytes.subspan(header.interval_count * kIntervalSize, header.page_count * kPageEntrySize);
    if (content_hash(entries) != header.content_hash) return corrupt("content hash mismatch");
    if (!all_zero(bytes.subspan(header.index_size()))) return corrupt("bytes behind a run's index that are not zero");
    if (header.light_records > 0 && job.light_paths_per_sample == 0)
        return corrupt("light records in a job that has no light paths");

    RunIndex index;
    ByteReader in(bytes);
    std::uint64_t reached = 0;  // intervals are sorted, disjoint and not adjacent
    for (std::uint32_t i = 0; i < header.interval_count; ++i) {
        const std::uint64_t first = in.get<std::uint64_t>();
        const SampleRange range{first, in.get<std::uint64_t>()};
        if (range.empty() || (i > 0 && range.first <= reached)) return corrupt("a run's intervals are not in order");
        reached = range.end;
        index.coverage.add(range);
    }
    const std::vector<SampleRange>& ranges = index.coverage.ranges();
    if (ranges.front().first != header.samples.first || ranges.back().end != header.samples.end ||
        index.coverage.size() != header.sample_count) {
        return corrupt("a run's intervals contradict its header");
    }
    RunHeader sums;
    index.pages.reserve(header.page_count);
    for (std::uint32_t i = 0; i < header.page_count; ++i) {
        Result<PageInfo> page = get_page_entry(in, job);
        if (!page) return page.error().at(fmt::format("page {}", i));
        page->offset = kRunHeaderSize + sums.pages_size;
        if (!index.pages.empty() && page->record_class < index.pages.back().record_class)
            return corrupt("light pages stand before camera pages");
        (page->record_class == RecordClass::kCamera ? sums.camera_records : sums.light_records) += page->record_count;
        sums.pair_count += page->pair_count;
        sums.decoded_size += page->decoded_size;
        sums.pages_size += page->stored_size;
        index.pages.push_back(*page);
    }
    if (sums.camera_records != header.camera_records || sums.light_records != header.light_records ||
        sums.pair_count != header.pair_count || sums.decoded_size != header.decoded_size || sums.pages_size != header.pages_size) {
        return corrupt("a run's pages do not add up to its header");
    }
    return index;
}

}  // namespace latent::sampledb
