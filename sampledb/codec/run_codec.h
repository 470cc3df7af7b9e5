// sampledb/codec/run_codec.h: records <-> a run's bytes. Order and page cut are functions of the records alone. docs/format.md,
// "Run".
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/result.h"
#include "sampledb/codec/page_encoder.h"
#include "sampledb/codec/row_sorter.h"
#include "sampledb/data/page.h"
#include "sampledb/data/record.h"
#include "sampledb/format/run_index.h"

namespace latent::sampledb {

// Records of a run, piece by piece, ascending by sample from piece to piece; within one in any order, those of a sample as emitted.
using Pieces = std::vector<std::shared_ptr<const Records>>;

// Makes one run after another; its memory (about 35 bytes per record) is kept for the next. It serves one thread at a time.
class RunBuilder {
 public:
    // One run, its values rounded to the precision of the job, ready to be written at a multiple of kBlock. The same bytes however
    // the records are cut into pieces. They belong to samples of `coverage`; samples may be without records. Pieces are let go as
    // they are taken up. `memory`: bytes that are no longer needed, whose memory the run is built in. Errors: kOutOfRange, naming
    // the sample whose record does not fit the job (kind, pairs, index, share, coverage).
    Result<Bytes> build(const Job& job, const Coverage& coverage, Pieces pieces, Bytes memory = {});

 private:
    RowSorter rows_;
    Page page_;
    PageEncoder encoder_;
};
// The same for a run alone.
Result<Bytes> encode_run(const Job& job, const Coverage& coverage, const Records& records, Bytes memory = {});

struct DecodedRun {
    RunHeader header;
    Coverage coverage;
    Records records;  // ascending by sample; records of one sample in an order that encode_run maps to the same run
};
// `bytes` begin with a run. Verifies every checksum. Errors: kTruncated, kForeign, kUnsupported, kCorrupt, kMismatch (another job).
Result<DecodedRun> decode_run(const Job& job, ByteSpan bytes);

// End of the page that begins at `begin`: the largest node of the binary tree over Z codes that begins there and holds at most
// `most` records. `z`: ascending Z prefixes of one class; looks no further than z[begin + most].
std::size_t page_end(std::span<const std::uint32_t> z, std::size_t begin, std::size_t most);

// Puts a run together page by page, for writers that cannot hold its records at once (compaction). The file gets kRunHeaderSize
// bytes of header (known last), the pages, and what `finish` returns.
class RunEncoder {
 public:
    RunEncoder(const Job& job, const Coverage& coverage);

    // The next page, as a PageEncoder made it: camera pages first, then light pages, each class ascending by (Z prefix, sample,
    // order of emission) and cut by `page_end`.
    void add_page(const PageInfo& page) { index_.pages.push_back(page); }

    struct Tail {
        RunHeader header;
        Bytes index;  // index and padding
    };
    Tail finish();

 private:
    RunHeader header_;
    RunIndex index_;
};

}  // namespace latent::sampledb
