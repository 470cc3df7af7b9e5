// sampledb/format/run_index.h: the coverage and the pages of a run as they stand behind its pages, bytes <-> struct.
// docs/format.md, "Run".
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/hash.h"
#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/page.h"
#include "sampledb/format/run_header.h"

namespace latent::sampledb {

// A run's coverage and pages, as they stand behind its pages.
struct RunIndex {
    Coverage coverage;
    std::vector<PageInfo> pages;  // offsets are relative to the run's first byte
};
// The index and its padding, which end the run; fills in the header's counts, sizes and hashes.
Bytes encode_run_index(const RunIndex& index, RunHeader& header);
// `bytes`: index and padding. Checks everything that the header says about it.
Result<RunIndex> decode_run_index(ByteSpan bytes, const RunHeader& header, const Job& job);

// Finds out which pages lie in one half of their nodes, from those before and behind them. `pages`: all of a run. docs/format.md,
// "Pages".
void find_parts(std::span<PageInfo> pages);

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
    RunHeader sums_;  // what the pages add up to
    std::optional<Error> error_;
};

}  // namespace latent::sampledb
