#include "sampledb/format/run_header.h"

#include "sampledb/data/limits.h"
#include "sampledb/format/frames.h"

namespace latent::sampledb {

std::uint64_t RunHeader::index_size() const { return interval_count * kIntervalSize + page_count * kPageEntrySize; }
std::uint64_t RunHeader::size() const { return round_up_to_block(index_offset() + index_size()); }

void put_run_entry(ByteWriter& out, const RunHeader& header) {
    out.put(kMajor);
    out.put(header.minor);
    out.put(header.interval_count);
    out.put(std::uint64_t{0});  // features
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
    RunHeader header;
    header.minor = in.get<std::uint16_t>();  // minor versions add nothing that must be understood
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
    if (Status s = check_version(major, features, 0); !s) return s.error();

    const std::uint64_t max_records = page_count * kMaxRecordsPerPage;  // page_count is small: checked first
    if (page_count > kMaxPagesPerRun || header.camera_records > max_records || header.light_records > max_records ||
        header.camera_records + header.light_records > max_records || header.camera_records + header.light_records < page_count ||
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

}  // namespace latent::sampledb
