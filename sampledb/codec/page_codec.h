// sampledb/codec/page_codec.h: the columns of one page <-> its stored bytes. Format: docs/format.md, "Page".
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/result.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"

namespace latent::sampledb {

// Appends the stored bytes of `page` to `out` and says what the index needs to know (offset excepted). Its records lie in one
// node and are sorted; positions are left out where the job's sampler yields every one of them.
PageInfo encode_page(const Job& job, const Page& page, Bytes& out);

// Decodes `stored`, the bytes that `info` describes, into `page`, of which nothing is left but its memory. Columns that are not
// asked for are empty; so is the page after an error. `every_column`: compare each decoded column with its content hash, not only
// those that were derived. Errors: kCorrupt, kUnsupported (a transform that this version does not know).
Status decode_page(const Job& job, const PageInfo& info, ByteSpan stored, const ColumnSet& columns, Page& page,
                   bool every_column = false);

// What each column of a page takes, for reports.
struct StoredColumn {
    std::string name;
    std::uint64_t stored, decoded;  // bytes
};
// Errors: kCorrupt.
Result<std::vector<StoredColumn>> stored_columns(const Job& job, const PageInfo& info, ByteSpan stored);

}  // namespace latent::sampledb
