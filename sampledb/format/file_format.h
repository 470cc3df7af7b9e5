// sampledb/format/file_format.h: the frames of a file: header, run headers, run index. Bytes <-> structs. docs/format.md rules.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/hash.h"
#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/job.h"
#include "sampledb/data/limits.h"
#include "sampledb/data/page.h"

namespace latent::sampledb {

inline constexpr std::uint64_t kBlock = 4096;  // headers, runs and the footer begin at multiples of it
inline constexpr std::uint16_t kRunMinor = 0;  // the version of a run that this program writes
inline constexpr std::size_t kRunHeaderSize = 256;
inline constexpr std::size_t kIntervalSize = 16;
inline constexpr std::size_t kPageEntrySize = 48;
inline constexpr std::size_t kRunEntrySize = 128;  // a run in the footer: its header without what is the same in all

// The file header: the job, and where this file comes from. It stands twice at the start of a file, so that no single
// damage makes the runs behind it unreadable.
struct FileHeader {
    Job job;
    std::string provenance_json;  // "" or a JSON object
};
// Both copies, ready to be written at offset 0; a multiple of kBlock. Errors: kOutOfRange (job.validate(), provenance too long).
Result<Bytes> encode_file_header(const FileHeader& header);
// Decodes one copy from bytes that begin with it. `copy_size`, if given, becomes the bytes that one copy occupies.
// Errors: kForeign (another magic), kTruncated, kUnsupported (a newer format), kCorrupt.
Result<FileHeader> decode_file_header(ByteSpan bytes, std::uint64_t* copy_size = nullptr);

// What stands at the front of a run. All but pages_size and index_hash is a function of (job, coverage).
struct RunHeader {
    JobId job;
    SampleRange samples;               // from the first to the end of its coverage
    std::uint64_t sample_count = 0;    // samples that it covers: samples.size() unless the coverage has gaps
    std::uint32_t interval_count = 0;  // of the coverage
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

// A run's coverage and pages, as they stand behind its pages.
struct RunIndex {
    Coverage coverage;
    std::vector<PageInfo> pages;  // offsets are relative to the run's first byte
};
// The index and its padding, which end the run; fills in the header's counts, sizes and hashes.
Bytes encode_run_index(const RunIndex& index, RunHeader& header);
// `bytes`: index and padding. Checks everything that the header says about it.
Result<RunIndex> decode_run_index(ByteSpan bytes, const RunHeader& header, const Job& job);

// The same of an index that is read a piece at a time, for it may be long.
class RunIndexDecoder {
 public:
    // Takes pages as they come, before all of the index is known to be sound. What it returns ends the decoding.
    using TakePage = std::function<Status(const PageInfo&)>;

    // Both are kept.
    RunIndexDecoder(const RunHeader& header, const Job& job, TakePage take);

    std::size_t next_size() const;  // bytes that `add` takes next; 0: there are no more
    // Errors: those of TakePage.
    Status add(ByteSpan piece);
    // After the last piece: the coverage. Errors: kTruncated, kCorrupt.
    Result<Coverage> finish();

 private:
    void add_intervals(ByteSpan piece);
    Status add_pages(ByteSpan piece);
    void refuse(std::string why);

    const RunHeader& header_;
    const Job& job_;
    std::uint64_t position_ = 0;
    Hasher64 hasher_;
    Hasher128 content_;
    std::vector<SampleRange> intervals_;
    TakePage take_;
    RunHeader sums_;  // of the pages
    std::optional<Error> error_;
};

// A run and where it begins in its file.
struct RunInfo {
    std::uint64_t offset = 0;
    RunHeader header;
    bool operator==(const RunInfo&) const = default;
};

}  // namespace latent::sampledb
