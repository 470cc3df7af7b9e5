// sampledb/read/origin.h: how the samples of a file were made, by one process or in parts that were merged. docs/format.md,
// "Header" and "Footer".
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "sampledb/read/file_reader.h"
#include "sampledb/read/provenance.h"

namespace latent::sampledb {

struct Origin {
    std::string common = "{}";  // JSON: members of the provenance that all parts have in common
    std::string parts = "[]";   // JSON: [{"samples": [[A, B], ...], "differences": {...}}, ...]; empty if nothing was merged
    std::size_t part_count = 0;
    bool incomplete = false;             // there were more parts than a file lists
    double cpu_seconds = 0;              // added up over all parts that say it, each since it was resumed
    bool all_timed = false;              // all of them say it
    std::uint64_t committed_before = 0;  // samples that they had when they were resumed
};

// A header or footer that is no JSON object is quoted, as a string, in `common` or `parts`: see quote_provenance.
Origin origin_of(const FileContents& file);

// The provenance of a file that was not merged: that of its header, with what its footer adds.
QuotedProvenance own_provenance(const FileContents& file);

}  // namespace latent::sampledb
