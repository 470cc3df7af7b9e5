#include "sampledb/format/footer.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/hash.h"
#include "sampledb/data/limits.h"
#include "sampledb/format/frames.h"

namespace latent::sampledb {

namespace {

// The first form: a head without a hash, entries that are run headers with their offsets, a trailer of 64 bytes.
constexpr std::size_t kFirstHeadSize = 24, kFirstEntrySize = 8 + kRunHeaderSize;
constexpr std::uint64_t kMaxFirstFooter = std::uint64_t{1} << 30;

Bytes encode_head(const FooterFrame& frame) {
    Bytes bytes;
    ByteWriter out(bytes);
    out.put(bytes_of(kFooterMagic));
    out.put(frame.offset);
    out.put(frame.run_count);
    out.put(frame.provenance_size);
    out.put(frame.entries_hash);
    out.put(frame.provenance_hash);
    out.put_zeros(8);
    out.put(hash64(bytes));
    return bytes;
}

Result<FooterFrame> decode_head(ByteSpan bytes) {
    if (bytes.size() < kFooterHeadSize || !begins_with(bytes, kFooterMagic)) return Error{ErrorCode::kTruncated, "has no footer"};
    ByteReader in(bytes.subspan(sizeof(Magic), kFooterHeadSize - sizeof(Magic)));
    FooterFrame frame;
    frame.offset = in.get<std::uint64_t>();
    frame.run_count = in.get<std::uint64_t>();
    frame.provenance_size = in.get<std::uint64_t>();
    frame.entries_hash = in.get<std::uint64_t>();
    frame.provenance_hash = in.get<std::uint64_t>();
    const bool reserved_zero = all_zero(in.take(8));
    if (in.get<std::uint64_t>() != hash64(bytes.first(kFooterHeadSize - 8))) return corrupt("footer checksum mismatch");
    if (!reserved_zero || frame.offset % kBlock != 0 || frame.run_count > kMaxRunsPerFile ||
        frame.provenance_size > kMaxFooterProvenance) {
        return corrupt("a footer of impossible size");
    }
    return frame;
}

// Whether a footer of the first form can hold as much.
bool first_form_holds(std::uint64_t run_count, std::uint64_t provenance_size) {
    constexpr std::uint64_t kRoom = kMaxFirstFooter - kFirstHeadSize - kFooterHeadSize;
    return run_count <= kRoom / kFirstEntrySize && provenance_size <= kRoom - run_count * kFirstEntrySize;
}

Result<FooterFrame> decode_first_form_end(ByteSpan end, std::uint64_t file_size) {
    ByteReader in(end);
    FooterFrame frame{.first_form = true};
    frame.offset = in.get<std::uint64_t>();
    const std::uint64_t size = in.get<std::uint64_t>();
    frame.entries_hash = in.get<std::uint64_t>();
    const bool reserved_zero = all_zero(in.take(24));
    if (in.get<std::uint64_t>() != hash64(end.first(kFooterHeadSize - 16))) return corrupt("footer checksum mismatch");
    if (!reserved_zero || size < kFirstHeadSize + kFooterHeadSize || size > kMaxFirstFooter || size > file_size ||
        frame.offset != file_size - size || frame.offset % kBlock != 0) {
        return corrupt("the footer is not at the offset given at its end");
    }
    return frame;
}

}  // namespace

Result<Bytes> encode_footer(std::span<const RunInfo> runs, std::string_view provenance_json, std::uint64_t offset) {
    Bytes bytes;
    const Result<std::uint64_t> size = put_footer(runs, provenance_json, offset, [&](ByteSpan piece) {
        bytes.insert(bytes.end(), piece.begin(), piece.end());
        return Status{};
    });
    if (!size) return size.error();
    return bytes;
}

Result<std::uint64_t> put_footer(std::span<const RunInfo> runs, std::string_view provenance_json, std::uint64_t offset,
                                 const std::function<Status(ByteSpan)>& put) {
    if (runs.size() > kMaxRunsPerFile)
        return Error{ErrorCode::kOutOfRange, fmt::format("{} runs; a file holds at most {}", runs.size(), kMaxRunsPerFile)};
    if (provenance_json.size() > kMaxFooterProvenance) return Error{ErrorCode::kOutOfRange, "provenance longer than 16 MiB"};
    constexpr std::size_t kRunsAtOnce = 8192;
    const auto entries_from = [&](std::size_t first) {
        Bytes entries;
        entries.reserve(std::min(runs.size() - first, kRunsAtOnce) * kRunEntrySize);
        ByteWriter out(entries);
        for (const RunInfo& run : runs.subspan(first, std::min(runs.size() - first, kRunsAtOnce))) put_run_entry(out, run.header);
        return entries;
    };
    Hasher64 entries_hash;
    for (std::size_t i = 0; i < runs.size(); i += kRunsAtOnce) entries_hash.update(entries_from(i));
    const ByteSpan provenance = std::as_bytes(std::span(provenance_json));
    const Bytes head = encode_head({false, offset, runs.size(), provenance.size(), entries_hash.digest(), hash64(provenance)});
    if (Status s = put(head); !s) return s.error();
    for (std::size_t i = 0; i < runs.size(); i += kRunsAtOnce) {
        if (Status s = put(entries_from(i)); !s) return s.error();
    }
    if (Status s = put(provenance); !s) return s.error();
    if (Status s = put(head); !s) return s.error();
    return 2 * head.size() + runs.size() * kRunEntrySize + provenance.size();
}

bool begins_footer(ByteSpan bytes, std::uint64_t offset) {
    if (begins_with(bytes, kFirstFooterMagic)) {
        return bytes.size() >= kFirstHeadSize &&
               first_form_holds(load_le<std::uint64_t>(&bytes[8]), load_le<std::uint64_t>(&bytes[16]));
    }
    const Result<FooterFrame> head = decode_head(bytes);
    return head && head->offset == offset;
}

Result<FooterFrame> decode_footer_end(ByteSpan end, std::uint64_t file_size) {
    if (end.size() == kFooterHeadSize && begins_with(end.last(sizeof(Magic)), kFirstFooterMagic))
        return decode_first_form_end(end, file_size);
    const Result<FooterFrame> frame = decode_head(end);
    if (!frame) return frame;
    const std::uint64_t size = 2 * kFooterHeadSize + frame->run_count * kRunEntrySize + frame->provenance_size;
    if (size > file_size || frame->offset != file_size - size) return corrupt("the footer is not at the offset given at its end");
    return frame;
}

Status decode_footer_head(ByteSpan head, std::uint64_t file_size, FooterFrame& frame) {
    if (!frame.first_form) return decode_head(head) == frame ? Status{} : corrupt("the footer's two ends differ");
    if (!begins_with(head, kFirstFooterMagic)) return corrupt("the footer is damaged");
    frame.run_count = load_le<std::uint64_t>(&head[8]);
    frame.provenance_size = load_le<std::uint64_t>(&head[16]);
    const bool fills_it = first_form_holds(frame.run_count, frame.provenance_size) &&
                          frame.provenance_at() + frame.provenance_size + kFooterHeadSize == file_size;
    return fills_it ? Status{} : corrupt("the footer's fields do not fill it");
}

Result<RunHeader> decode_footer_entry(const FooterFrame& frame, ByteSpan entry, std::uint64_t offset) {
    if (!frame.first_form) return decode_run_entry(entry);
    if (load_le<std::uint64_t>(entry.data()) != offset) return corrupt("does not begin where the run before it ends");
    return decode_run_header(entry.subspan(8));
}

std::size_t FooterFrame::head_size() const { return first_form ? kFirstHeadSize : kFooterHeadSize; }
std::size_t FooterFrame::entry_size() const { return first_form ? kFirstEntrySize : kRunEntrySize; }

}  // namespace latent::sampledb
