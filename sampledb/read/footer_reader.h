// sampledb/read/footer_reader.h: what a footer lists, a piece at a time: the list may be long. docs/format.md, "Footer".
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "base/result.h"
#include "sampledb/format/footer.h"
#include "sampledb/read/byte_source.h"

namespace latent::sampledb {

// The end of a footer, if the file ends with one; what lies before it may be damaged. Errors: kTruncated (there is none), kCorrupt,
// kIo.
Result<FooterFrame> read_footer_end(const ByteSource& source);

// A footer whose checksums are right.
class FooterReader {
 public:
    // `source` is kept. Errors: kCorrupt, kIo.
    static Result<FooterReader> open(const ByteSource& source, const FooterFrame& end);

    std::uint64_t offset() const { return frame_.offset; }
    std::uint64_t run_count() const { return frame_.run_count; }
    // Calls `visit` with the runs, in their order, the first at `begin`. Errors: kCorrupt and kUnsupported (a list that cannot be
    // that of a file of this job whose runs fill what is between `begin` and the footer), kIo.
    Status for_each_run(std::uint64_t begin, const JobId& job, const std::function<void(const RunInfo&)>& visit) const;
    // "" if it is longer than kMaxFooterProvenance. Errors: kIo.
    Result<std::string> provenance() const;

 private:
    FooterReader(const ByteSource& source, const FooterFrame& frame) : source_(&source), frame_(frame) {}
    Status check_hashes() const;
    Result<std::uint64_t> hash_of(std::uint64_t begin, std::uint64_t size) const;

    const ByteSource* source_;
    FooterFrame frame_;
};

}  // namespace latent::sampledb
