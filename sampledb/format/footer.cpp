#include "sampledb/format/file_format.h"
#include "sampledb/format/frames.h"

namespace latent::sampledb {

namespace {

constexpr std::size_t kFrontSize = 24;

}  // namespace

Bytes encode_footer(const Footer& footer, std::uint64_t offset) {
    Bytes bytes;
    bytes.reserve(kFrontSize + footer.runs.size() * (8 + kRunHeaderSize) + footer.provenance_json.size() + kFooterTrailerSize);
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
    if (size < kFrontSize + kFooterTrailerSize || size > kMaxFooterSize || size > file_size || offset != file_size - size ||
        offset % kBlock != 0) {
        return corrupt("the footer is not where its trailer says");
    }
    return offset;
}

Result<Footer> decode_footer(ByteSpan bytes, std::uint64_t offset, const JobId& job) {
    if (bytes.size() < kFrontSize + kFooterTrailerSize || !begins_with(bytes, kFooterMagic))
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
