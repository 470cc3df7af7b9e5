// sampledb/format/run_header.h: the header of a run, bytes <-> struct. docs/format.md, "Run".
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/bytes.h"
#include "base/hash.h"
#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/job.h"

namespace latent::sampledb {

inline constexpr std::uint16_t kRunMinor = 0;  // the version of a run that this program writes
inline constexpr std::size_t kRunHeaderSize = 256;
inline constexpr std::size_t kIntervalSize = 16;
inline constexpr std::size_t kPageEntrySize = 48;
inline constexpr std::size_t kRunEntrySize = 128;  // a run in the footer: its header without what is the same in all

// What stands at the front of a run. All but pages_size and index_hash is a function of (job, coverage).
struct RunHeader {
    JobId job;
    SampleRange samples;               // from the first to the end of its coverage
    std::uint64_t sample_count = 0;    // samples that it covers: samples.size() unless the coverage has gaps
    std::uint32_t interval_count = 0;  // intervals of the coverage
    std::uint32_t page_count = 0;
    std::uint64_t camera_records = 0, light_records = 0;
    std::uint64_t pair_count = 0;     // spectral: pairs of all records
    std::uint64_t decoded_size = 0;   // bytes of all columns of all pages
    std::uint64_t pages_size = 0;     // stored bytes of all pages
    std::uint64_t index_hash = 0;     // XXH3-64 of index and padding
    Hash128 content_hash;             // XXH3-128 over nodes, counts and decoded columns of all pages
    std::uint16_t minor = kRunMinor;  // a copied run keeps its own, also in a footer

    std::uint64_t index_offset() const { return kRunHeaderSize + pages_size; }  // in the run
    std::uint64_t index_size() const;                                           // bytes of the index, without padding
    std::uint64_t size() const;  // bytes that the run takes in the file: header, pages, index, padding
    bool operator==(const RunHeader&) const = default;
};
// Exactly kRunHeaderSize bytes.
Bytes encode_run_header(const RunHeader& header);
// Errors: kTruncated, kForeign (no run begins here), kUnsupported, kCorrupt (hash, or a field over its ceiling).
Result<RunHeader> decode_run_header(ByteSpan bytes);

// What a run's header says in every version of the format: enough to name a run that cannot be read, and to step over it.
struct RunFrame {
    JobId job;
    SampleRange samples;
    std::uint64_t size = 0;  // bytes that the run takes in the file
};
// Errors: kTruncated, kForeign (no run begins here), kCorrupt (hash).
Result<RunFrame> decode_run_frame(ByteSpan bytes);

// A header as it stands in a footer: kRunEntrySize bytes. Errors as of decode_run_header.
void put_run_entry(ByteWriter& out, const RunHeader& header);
Result<RunHeader> decode_run_entry(ByteSpan entry);

// A run and where it begins in its file.
struct RunInfo {
    std::uint64_t offset = 0;
    RunHeader header;
    bool operator==(const RunInfo&) const = default;
};

}  // namespace latent::sampledb
