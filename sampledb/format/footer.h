// sampledb/format/footer.h: the list of runs that ends a finished file and spares its reader the walk. Bytes <-> structs.
// docs/format.md, "Footer".
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include "base/bytes.h"
#include "base/result.h"
#include "sampledb/format/run_header.h"

namespace latent::sampledb {

inline constexpr std::size_t kFooterHeadSize = 64;  // the bytes that a footer begins and ends with
inline constexpr std::uint64_t kMaxFooterProvenance = std::uint64_t{16} << 20;

// Ready to be written at `offset`, the end of the last of the runs, which stand one behind the other. `provenance_json`: "" or
// JSON, what a merged file was made from. Errors: kOutOfRange (more runs, or a longer provenance, than a file takes).
Result<Bytes> encode_footer(std::span<const RunInfo> runs, std::string_view provenance_json, std::uint64_t offset);
// The same, given to `put` a piece after the other: the list may be long. Returns the footer's size. Errors: those of `put`, too.
Result<std::uint64_t> put_footer(std::span<const RunInfo> runs, std::string_view provenance_json, std::uint64_t offset,
                                 const std::function<Status(ByteSpan)>& put);

// Whether the bytes at `offset` of a file begin like a footer, which ends a walk. The file may end soon after.
bool begins_footer(ByteSpan bytes, std::uint64_t offset);

// What the two ends of a footer say.
struct FooterFrame {
    bool first_form = false;                           // as version 0.1 wrote it
    std::uint64_t offset = 0;                          // where its first byte is
    std::uint64_t run_count = 0, provenance_size = 0;  // the first form says them in its head only
    std::uint64_t entries_hash = 0;                    // first form: of everything before the end
    std::uint64_t provenance_hash = 0;
    bool operator==(const FooterFrame&) const = default;

    std::size_t head_size() const;
    std::size_t entry_size() const;
    std::uint64_t entries_at() const { return offset + head_size(); }
    std::uint64_t provenance_at() const { return entries_at() + run_count * entry_size(); }
};
// From the last kFooterHeadSize bytes of a file. Errors: kTruncated (it does not end with a footer), kCorrupt.
Result<FooterFrame> decode_footer_end(ByteSpan end, std::uint64_t file_size);
// `head`: the first frame.head_size() bytes. Completes the frame, or compares it. Errors: kCorrupt.
Status decode_footer_head(ByteSpan head, std::uint64_t file_size, FooterFrame& frame);
// An entry of frame.entry_size() bytes, of a run at `offset`. Errors: those of decode_run_header; kCorrupt (a run elsewhere).
Result<RunHeader> decode_footer_entry(const FooterFrame& frame, ByteSpan entry, std::uint64_t offset);

}  // namespace latent::sampledb
