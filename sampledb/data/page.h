// sampledb/data/page.h: the unit of decoding: the records of one class that lie in one quadtree node of the film. docs/format.md,
// "Page".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sampledb/data/job.h"
#include "sampledb/data/record.h"

namespace latent::sampledb {

// A dyadic square (a rectangle in pixels) of the film: side 2^-level, at (x, y) in units of its side.
struct FilmNode {
    std::uint8_t level = 0;  // 0: the whole film .. 32
    std::uint32_t x = 0, y = 0;
    bool operator==(const FilmNode&) const = default;
};

// Where in its node a page lies: the film is cut into halves by v, and these into squares.
enum class NodePart : std::uint8_t { kAnywhere, kUpper, kLower };

// What the index says of a page, before it is decoded.
struct PageInfo {
    FilmNode node;  // all its records lie in it
    RecordClass record_class;
    NodePart part = NodePart::kAnywhere;  // as far as it is known: see find_parts
    std::uint32_t record_count;
    std::uint32_t pair_count;    // spectral: pairs of all its records
    std::uint64_t offset;        // absolute in the file
    std::uint32_t stored_size;   // bytes on disk
    std::uint32_t decoded_size;  // bytes of all columns
    std::uint64_t stored_hash;   // XXH3-64 of the stored bytes
    std::uint64_t content_hash;  // XXH3-64 over the hashes of its decoded columns
};

// Decoded columns of one page; `Page` objects are reused, so decoding allocates only when a page is larger than any before.
// Columns have `count` rows (and kPadding readable rows after them, for SIMD loads).
struct Page : Columns {
    static constexpr std::size_t kPadding = 16;
    RecordClass record_class = RecordClass::kCamera;
    std::size_t count = 0;
    bool unit_share = true;                 // every share is 1: `share` is empty
    std::vector<std::uint32_t> first_pair;  // spectral: where each record's pairs begin in `power`; one more at the end
};

// The share of a row: 0 for a light record, 1 where the page stores none.
inline float share_of(const Page& page, std::size_t row) {
    return page.record_class == RecordClass::kLight ? 0.0f : page.unit_share ? 1.0f : page.share[row];
}

// The wavelengths [nm] of a row, one for each of its pairs: those that are stored, or, in jobs with a density, of a batch of k.
void wavelengths_of(const WavelengthDensity& density, std::size_t k, const Page& page, std::size_t row, std::span<float> lambda_nm);

// Whether pages of this class, in files of this job, have a column.
inline bool has_column(const Job& job, RecordClass record_class, Presence presence) {
    return is_present(presence, job.kind, !job.density.empty(), record_class);
}

// A job's extra columns, without values.
std::vector<ExtraColumn> extra_columns(const Job& job);

// The most records that a page of this job holds.
std::size_t max_page_records(const Job& job);

// Bytes of all columns of a page in memory.
std::uint64_t decoded_page_size(const Job& job, RecordClass record_class, std::uint64_t records, std::uint64_t pairs);

}  // namespace latent::sampledb
