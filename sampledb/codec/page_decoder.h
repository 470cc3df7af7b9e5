// sampledb/codec/page_decoder.h: the stored bytes of one page -> its columns. Format: docs/format.md, "Page".
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/result.h"
#include "sampledb/codec/column_decode.h"
#include "sampledb/codec/page_layout.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"

namespace latent::sampledb {

// Keeps its memory from page to page; serves one thread at a time, and any job.
class PageDecoder {
 public:
    // Decodes `stored`, the bytes that `info` describes, into `page`, of which nothing is left but its memory. Columns that are not
    // asked for are empty; so is the page after an error. `every_column`: compare each decoded column with its content hash, not
    // only those that were derived. Errors: kCorrupt, kUnsupported (a transform that this version does not know).
    Status decode(const Job& job, const PageInfo& info, ByteSpan stored, const ColumnSet& columns, Page& page,
                  bool every_column = false);

    // Room for the stored bytes of a page, until the next call.
    std::span<std::byte> stored(std::size_t size) { return at_least(stored_, size); }

 private:
    class Decoding;

    Bytes stored_;
    std::vector<ColumnEntry> table_;
    ColumnDecoder columns_;
    BrightRows bright_;
    std::vector<std::uint64_t> numbers_;
};

// What each column of a page takes, for reports.
struct StoredColumn {
    std::string name;
    std::uint64_t stored, decoded;  // bytes
};
// Errors: kCorrupt.
Result<std::vector<StoredColumn>> stored_columns(const Job& job, const PageInfo& info, ByteSpan stored);

}  // namespace latent::sampledb
