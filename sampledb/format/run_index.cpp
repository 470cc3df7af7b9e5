#include "sampledb/format/run_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sampledb/data/limits.h"
#include "sampledb/data/z_order.h"
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

// Adds what entries, kPageEntrySize bytes each, say of their records.
void update_content(Hasher128& hasher, ByteSpan entries) {
    for (std::size_t at = 0; at < entries.size(); at += kPageEntrySize) hasher.update(entries.subspan(at, kPageContentSize));
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
    if (record_class > 1) return corrupt("a page of unknown class");
    if (reserved != 0) return corrupt("a page's entry with reserved bytes that are not zero");
    page.record_class = RecordClass{record_class};
    if (page.node.level > kZPrefixLevels || page.node.x >> page.node.level != 0 || page.node.y >> page.node.level != 0) {
        return corrupt("a page outside the film");
    }
    if (page.record_count == 0 || page.record_count > max_page_records(job) ||
        page.pair_count > std::uint64_t{page.record_count} * job.batch) {
        return corrupt("a page with too many records or pairs");
    }
    if (page.decoded_size != decoded_page_size(job, page.record_class, page.record_count, page.pair_count) ||
        page.stored_size > page.decoded_size + kMaxStoredOverhead) {
        return corrupt("a page whose size contradicts its records");
    }
    return page;
}

}  // namespace

Bytes encode_run_index(const RunIndex& index, RunHeader& header) {
    const std::span<const SampleRange> ranges = index.coverage.ranges();
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
    Hasher128 content;
    update_content(content, ByteSpan(bytes).subspan(ranges.size() * kIntervalSize));
    header.content_hash = content.digest();
    out.put_zeros(header.size() - header.index_offset() - bytes.size());
    header.index_hash = hash64(bytes);
    return bytes;
}

void find_parts(std::span<PageInfo> pages) {
    // Pages are nodes of the binary tree, and named by the smallest square that holds their records. If that square has room for a
    // neighbour's too, it is larger than the page's node, which is then half of it: no two pages have a position in common, but for
    // those of the smallest squares.
    const auto holds = [](const PageInfo& page, const PageInfo& other) {
        const int finer = other.node.level - page.node.level;
        return page.node.level < kZPrefixLevels && page.record_class == other.record_class && finer >= 0 &&
               other.node.x >> finer == page.node.x && other.node.y >> finer == page.node.y;
    };
    for (std::size_t i = 0; i + 1 < pages.size(); ++i) {
        if (holds(pages[i], pages[i + 1])) pages[i].part = NodePart::kUpper;
        if (holds(pages[i + 1], pages[i])) pages[i + 1].part = NodePart::kLower;
    }
}

RunIndexDecoder::RunIndexDecoder(const RunHeader& header, const Job& job, TakePage take)
    : header_(header), job_(job), take_(std::move(take)) {
    intervals_.reserve(header.interval_count);
}

std::size_t RunIndexDecoder::next_size() const {
    constexpr std::uint64_t kPagesAtOnce = 1 << 14;
    const std::uint64_t intervals = header_.interval_count * kIntervalSize;
    if (position_ < intervals) return intervals;
    if (position_ < header_.index_size()) return std::min(header_.index_size() - position_, kPagesAtOnce * kPageEntrySize);
    return header_.size() - header_.index_offset() - position_;
}

Status RunIndexDecoder::add(ByteSpan piece) {
    hasher_.update(piece);
    const std::uint64_t begin = std::exchange(position_, position_ + piece.size());
    if (begin == 0) {
        add_intervals(piece);
    } else if (begin < header_.index_size()) {
        update_content(content_, piece);
        return add_pages(piece);
    } else if (!all_zero(piece)) {
        refuse("nonzero bytes after a run's index");
    }
    return {};
}

void RunIndexDecoder::add_intervals(ByteSpan piece) {
    ByteReader in(piece);
    std::uint64_t samples = 0;
    while (in.remaining() > 0) {
        const std::uint64_t first = in.get<std::uint64_t>();
        const SampleRange range{first, in.get<std::uint64_t>()};
        if (range.empty() || (!intervals_.empty() && range.first <= intervals_.back().end))
            return refuse("a run's intervals are not in order");
        intervals_.push_back(range);
        samples += range.size();
    }
    if (intervals_.front().first != header_.samples.first || intervals_.back().end != header_.samples.end ||
        samples != header_.sample_count) {
        refuse("a run's intervals contradict its header");
    }
}

Status RunIndexDecoder::add_pages(ByteSpan piece) {
    ByteReader in(piece);
    while (in.remaining() > 0 && !error_) {
        Result<PageInfo> page = get_page_entry(in, job_);
        if (!page) {
            refuse(fmt::format("page {}: {}", sums_.page_count, page.error().message));
            break;
        }
        page->offset = kRunHeaderSize + sums_.pages_size;
        if (page->record_class == RecordClass::kCamera && sums_.light_records > 0) {
            refuse("light pages come before camera pages");
            break;
        }
        (page->record_class == RecordClass::kCamera ? sums_.camera_records : sums_.light_records) += page->record_count;
        sums_.pair_count += page->pair_count;
        sums_.decoded_size += page->decoded_size;
        sums_.pages_size += page->stored_size;
        ++sums_.page_count;
        if (Status s = take_(*page); !s) return s;
    }
    return {};
}

void RunIndexDecoder::refuse(std::string why) {
    if (!error_) error_ = corrupt(std::move(why));
}

Result<Coverage> RunIndexDecoder::finish() {
    if (next_size() != 0) return Error{ErrorCode::kTruncated, "ends inside a run's index"};
    if (hasher_.digest() != header_.index_hash) return corrupt("run index checksum mismatch");
    if (content_.digest() != header_.content_hash) return corrupt("content hash mismatch");
    if (error_) return *error_;
    if (header_.light_records > 0 && job_.light_paths_per_sample == 0)
        return corrupt("light records in a job that has no light paths");
    if (sums_.camera_records != header_.camera_records || sums_.light_records != header_.light_records ||
        sums_.pair_count != header_.pair_count || sums_.decoded_size != header_.decoded_size ||
        sums_.pages_size != header_.pages_size) {
        return corrupt("a run's pages do not add up to its header");
    }
    return Coverage::of(std::move(intervals_));
}

Result<RunIndex> decode_run_index(ByteSpan bytes, const RunHeader& header, const Job& job) {
    if (bytes.size() != header.size() - header.index_offset()) return Error{ErrorCode::kTruncated, "ends inside a run's index"};
    RunIndex index;
    index.pages.reserve(header.page_count);
    RunIndexDecoder decoder(header, job, [&](const PageInfo& page) {
        index.pages.push_back(page);
        return Status{};
    });
    for (std::size_t at = 0, size = 0; (size = decoder.next_size()) > 0; at += size) {
        if (Status s = decoder.add(bytes.subspan(at, size)); !s) return s.error();
    }
    Result<Coverage> coverage = decoder.finish();
    if (!coverage) return coverage.error();
    index.coverage = std::move(*coverage);
    return index;
}

}  // namespace latent::sampledb
