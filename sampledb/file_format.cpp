#include "sampledb/file_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "sampledb/page_codec.h"
#include "sampledb/z_order.h"

namespace latent::sampledb {

namespace {

// A byte that is no text, what follows, and a line end that text-mode transfers would break.
using Magic = std::array<unsigned char, 8>;
constexpr Magic kFileMagic = {0x8D, 'L', 'T', 'D', 'B', 'F', '\r', '\n'};
constexpr Magic kRunMagic = {0x8D, 'L', 'T', 'D', 'B', 'R', '\r', '\n'};
constexpr Magic kFooterMagic = {0x8D, 'L', 'T', 'D', 'B', 'E', '\r', '\n'};
constexpr std::uint16_t kMajor = 1, kMinor = 0;
constexpr std::uint64_t kKnownFeatures = 0;
constexpr std::size_t kHeaderBlockSize = 64;
constexpr std::size_t kIntervalSize = 16;
constexpr std::size_t kPageContentSize = 32;  // the part of a page's entry that is a function of its records
constexpr std::size_t kFooterFrontSize = 24;

ByteSpan bytes_of(const Magic& magic) { return std::as_bytes(std::span(magic)); }
bool begins_with(ByteSpan bytes, const Magic& magic) {
    return bytes.size() >= magic.size() &&
           std::equal(magic.begin(), magic.end(), bytes.begin(), [](unsigned char a, std::byte b) { return std::byte{a} == b; });
}
bool all_zero(ByteSpan bytes) {
    return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}
std::uint64_t round_up(std::uint64_t size) { return (size + kBlock - 1) / kBlock * kBlock; }

Error corrupt(std::string what) { return {ErrorCode::kCorrupt, std::move(what)}; }

void put_hash(ByteWriter& out, const Hash128& hash) {
    out.put(hash.low);
    out.put(hash.high);
}
Hash128 get_hash(ByteReader& in) {
    const std::uint64_t low = in.get<std::uint64_t>();
    return {low, in.get<std::uint64_t>()};
}

Bytes encode_job(const FileHeader& header) {
    const Job& job = header.job;
    Bytes body;
    ByteWriter out(body);
    put_hash(out, job.id);
    out.put(job.aspect_width);
    out.put(job.aspect_height);
    out.put(static_cast<std::uint8_t>(job.kind));
    out.put(static_cast<std::uint8_t>(job.positions.sampler));
    out.put(job.batch);
    out.put(job.light_paths_per_sample);
    out.put(job.light_unit_cd_m2);
    out.put(job.run_bytes);
    out.put(job.run_samples);
    out.put(job.positions.shift_u);
    out.put(job.positions.shift_v);
    out.put(static_cast<std::uint32_t>(job.density.knots().size()));
    out.put(static_cast<std::uint32_t>(job.extra.size()));
    out.put(static_cast<std::uint32_t>(header.provenance_json.size()));
    for (const WavelengthDensity::Knot& knot : job.density.knots()) {
        out.put(knot.cumulative);
        out.put(knot.lambda);
    }
    for (const ExtraColumnSpec& column : job.extra) {
        out.put(static_cast<std::uint8_t>(column.type));
        out.put(static_cast<std::uint8_t>(column.name.size()));
        out.put(std::as_bytes(std::span(column.name)));
    }
    out.put(std::as_bytes(std::span(header.provenance_json)));
    return body;
}

std::string get_text(ByteReader& in, std::size_t size) {
    const ByteSpan text = in.take(size);
    std::string result(text.size(), '\0');
    std::transform(text.begin(), text.end(), result.begin(), [](std::byte b) { return static_cast<char>(b); });
    return result;
}

Result<FileHeader> decode_job(ByteSpan body, bool exact) {
    FileHeader header;
    Job& job = header.job;
    ByteReader in(body);
    job.id = get_hash(in);
    job.aspect_width = in.get<std::uint32_t>();
    job.aspect_height = in.get<std::uint32_t>();
    job.kind = RecordKind{in.get<std::uint8_t>()};
    job.positions.sampler = PositionSampler{in.get<std::uint8_t>()};
    job.batch = in.get<std::uint16_t>();
    job.light_paths_per_sample = in.get<std::uint32_t>();
    job.light_unit_cd_m2 = in.get<double>();
    job.run_bytes = in.get<std::uint64_t>();
    job.run_samples = in.get<std::uint32_t>();
    job.positions.shift_u = in.get<std::uint32_t>();
    job.positions.shift_v = in.get<std::uint32_t>();
    const std::uint32_t knot_count = in.get<std::uint32_t>();
    const std::uint32_t extra_count = in.get<std::uint32_t>();
    const std::uint32_t provenance_size = in.get<std::uint32_t>();
    if (knot_count > in.remaining() / 12 || extra_count > kMaxExtraColumns || provenance_size > kMaxProvenanceSize) {
        return corrupt("the header counts more than it holds");
    }
    std::vector<WavelengthDensity::Knot> knots(knot_count);
    for (WavelengthDensity::Knot& knot : knots) {
        knot.cumulative = in.get<std::uint64_t>();
        knot.lambda = in.get<std::uint32_t>();
    }
    for (std::uint32_t i = 0; i < extra_count; ++i) {
        const ColumnType type{in.get<std::uint8_t>()};
        const std::uint8_t name_size = in.get<std::uint8_t>();
        job.extra.push_back({get_text(in, name_size), type});
    }
    header.provenance_json = get_text(in, provenance_size);
    if (!in.ok() || (exact && in.remaining() != 0)) return corrupt("the header's fields do not fill it");
    if (knot_count != 0) {
        Result<WavelengthDensity> density = WavelengthDensity::from_knots(std::move(knots));
        if (!density) return corrupt(density.error().message);
        job.density = std::move(*density);
    }
    if (Status s = job.validate(); !s) {
        return Error{s.error().code == ErrorCode::kUnsupported ? ErrorCode::kUnsupported : ErrorCode::kCorrupt, s.error().message};
    }
    return header;
}

Status check_version(std::uint16_t major, std::uint64_t features) {
    if (major != kMajor)
        return Error{ErrorCode::kUnsupported, fmt::format("format version {}, this program reads version {}", major, kMajor)};
    if ((features & ~kKnownFeatures) != 0) {
        return Error{ErrorCode::kUnsupported,
                     fmt::format("needs features {:#x} that this program does not know", features & ~kKnownFeatures)};
    }
    return {};
}

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
    if (page.record_count == 0 || page.record_count > kMaxRecordsPerPage ||
        page.pair_count > std::uint64_t{page.record_count} * job.batch) {
        return corrupt("a page of more records or pairs than there may be");
    }
    if (page.decoded_size != decoded_page_size(job, page.record_class, page.record_count, page.pair_count) ||
        page.decoded_size > kMaxDecodedPage || page.stored_size > page.decoded_size + kMaxStoredOverhead) {
        return corrupt("a page whose size contradicts its records");
    }
    return page;
}

}  // namespace

Result<Bytes> encode_file_header(const FileHeader& header) {
    if (Status s = header.job.validate(); !s) return s.error();
    if (header.provenance_json.size() > kMaxProvenanceSize) return Error{ErrorCode::kOutOfRange, "provenance longer than 512 KiB"};
    const Bytes body = encode_job(header);
    const std::uint64_t copy_size = round_up(kHeaderBlockSize + body.size());
    Bytes rest = body;
    rest.resize(copy_size - kHeaderBlockSize);

    Bytes file;
    ByteWriter out(file);
    out.put(bytes_of(kFileMagic));
    out.put(kMajor);
    out.put(kMinor);
    out.put(static_cast<std::uint32_t>(copy_size));
    out.put(kKnownFeatures);
    out.put(static_cast<std::uint64_t>(body.size()));
    out.put(hash64(rest));
    out.put_zeros(16);
    out.put(hash64(file));
    out.put(rest);
    const Bytes copy = file;
    out.put(copy);
    return file;
}

Result<FileHeader> decode_file_header(ByteSpan bytes, std::uint64_t* copy_size) {
    if (!begins_with(bytes, kFileMagic)) return Error{ErrorCode::kForeign, "not a Latent file"};
    if (bytes.size() < kHeaderBlockSize) return Error{ErrorCode::kTruncated, "ends inside its header"};
    ByteReader in(bytes.subspan(sizeof(Magic)));
    const std::uint16_t major = in.get<std::uint16_t>();
    const std::uint16_t minor = in.get<std::uint16_t>();
    const std::uint64_t size = in.get<std::uint32_t>();
    const std::uint64_t features = in.get<std::uint64_t>();
    const std::uint64_t body_size = in.get<std::uint64_t>();
    const std::uint64_t body_hash = in.get<std::uint64_t>();
    in.take(16);
    if (in.get<std::uint64_t>() != hash64(bytes.first(kHeaderBlockSize - 8))) return corrupt("header checksum mismatch");
    if (Status s = check_version(major, features); !s) return s.error();
    if (size % kBlock != 0 || size == 0 || size > kMaxHeaderSize || body_size > size - kHeaderBlockSize) {
        return corrupt("a header of impossible size");
    }
    if (copy_size != nullptr) *copy_size = size;
    if (bytes.size() < size) return Error{ErrorCode::kTruncated, "ends inside its header"};
    if (hash64(bytes.subspan(kHeaderBlockSize, size - kHeaderBlockSize)) != body_hash) return corrupt("header checksum mismatch");
    return decode_job(bytes.subspan(kHeaderBlockSize, body_size), minor <= kMinor);
}

std::uint64_t RunHeader::index_size() const { return interval_count * kIntervalSize + page_count * kPageEntrySize; }
std::uint64_t RunHeader::size() const { return round_up(index_offset() + index_size()); }

Bytes encode_run_header(const RunHeader& header) {
    Bytes bytes;
    bytes.reserve(kRunHeaderSize);
    ByteWriter out(bytes);
    out.put(bytes_of(kRunMagic));
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
    out.put_zeros(kRunHeaderSize - 8 - bytes.size());
    out.put(hash64(bytes));
    return bytes;
}

Result<RunHeader> decode_run_header(ByteSpan bytes) {
    if (!begins_with(bytes, kRunMagic)) return Error{ErrorCode::kForeign, "no run begins here"};
    if (bytes.size() < kRunHeaderSize) return Error{ErrorCode::kTruncated, "ends inside a run's header"};
    ByteReader in(bytes.subspan(sizeof(Magic), kRunHeaderSize - sizeof(Magic)));
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
    const bool reserved_zero = all_zero(in.take(in.remaining() - 8));
    if (in.get<std::uint64_t>() != hash64(bytes.first(kRunHeaderSize - 8))) return corrupt("run header checksum mismatch");
    if (Status s = check_version(major, features); !s) return s.error();

    if (!reserved_zero) return corrupt("a run header with unknown fields");
    const std::uint64_t most_records = page_count * kMaxRecordsPerPage;  // page_count is small: checked first
    if (page_count > kMaxPagesPerRun || header.camera_records > most_records || header.light_records > most_records ||
        header.camera_records + header.light_records > most_records || header.camera_records + header.light_records < page_count ||
        header.pair_count > most_records * kMaxPairs || header.decoded_size > page_count * kMaxDecodedPage ||
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

Bytes encode_footer(const Footer& footer, std::uint64_t offset) {
    Bytes bytes;
    bytes.reserve(kFooterFrontSize + footer.runs.size() * (8 + kRunHeaderSize) + footer.provenance_json.size() +
                  kFooterTrailerSize);
    ByteWriter out(bytes);
    out.put(bytes_of(kFooterMagic));
    out.put(static_cast<std::uint64_t>(footer.runs.size()));
    out.put(static_cast<std::uint64_t>(footer.provenance_json.size()));
    for (const RunInfo& run : footer.runs) {
        out.put(run.offset);
        out.put(encode_run_header(run.header));
    }
    out.put(std::as_bytes(std::span(footer.provenance_json)));
    const std::uint64_t hash = hash64(bytes);
    const std::size_t front = bytes.size();
    out.put(offset);
    out.put(static_cast<std::uint64_t>(front + kFooterTrailerSize));
    out.put(hash);
    out.put_zeros(24);
    out.put(hash64(ByteSpan(bytes).subspan(front)));
    out.put(bytes_of(kFooterMagic));
    return bytes;
}

Result<std::uint64_t> decode_footer_trailer(ByteSpan trailer, std::uint64_t file_size) {
    if (trailer.size() != kFooterTrailerSize || !begins_with(trailer.last(sizeof(Magic)), kFooterMagic)) {
        return Error{ErrorCode::kTruncated, "has no footer"};
    }
    ByteReader in(trailer);
    const std::uint64_t offset = in.get<std::uint64_t>();
    const std::uint64_t size = in.get<std::uint64_t>();
    in.take(32);
    if (in.get<std::uint64_t>() != hash64(trailer.first(kFooterTrailerSize - 16))) return corrupt("footer checksum mismatch");
    if (size < kFooterFrontSize + kFooterTrailerSize || size > kMaxFooterSize || size > file_size || offset != file_size - size ||
        offset % kBlock != 0) {
        return corrupt("the footer is not where its trailer says");
    }
    return offset;
}

Result<Footer> decode_footer(ByteSpan bytes, std::uint64_t offset, const JobId& job) {
    if (bytes.size() < kFooterFrontSize + kFooterTrailerSize || !begins_with(bytes, kFooterMagic))
        return corrupt("the footer is damaged");
    const ByteSpan body = bytes.first(bytes.size() - kFooterTrailerSize);
    ByteReader trailer(bytes.last(kFooterTrailerSize));
    trailer.take(16);
    if (trailer.get<std::uint64_t>() != hash64(body)) return corrupt("footer checksum mismatch");
    ByteReader in(body.subspan(sizeof(Magic)));
    const std::uint64_t run_count = in.get<std::uint64_t>();
    const std::uint64_t provenance_size = in.get<std::uint64_t>();
    if (run_count > kMaxRunsPerFile || run_count > in.remaining() / (8 + kRunHeaderSize))
        return corrupt("the footer counts more runs than it holds");
    Footer footer;
    footer.runs.reserve(run_count);
    std::uint64_t reached = 0;
    for (std::uint64_t i = 0; i < run_count; ++i) {
        const std::uint64_t at = in.get<std::uint64_t>();
        const Result<RunHeader> header = decode_run_header(in.take(kRunHeaderSize));
        if (!header) return header.error().at("footer");
        if (at % kBlock != 0 || at < reached || at > offset || header->size() > offset - at || header->job != job) {
            return corrupt("the footer lists a run that cannot be there");
        }
        reached = at + header->size();
        footer.runs.push_back({at, *header});
    }
    if (provenance_size != in.remaining()) return corrupt("the footer's fields do not fill it");
    footer.provenance_json = get_text(in, provenance_size);
    return footer;
}

}  // namespace latent::sampledb
