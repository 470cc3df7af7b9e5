// sampledb/codec/row_sorter.h: the rows of a run in canonical order: class, Z prefix, sample, order of emission. docs/format.md,
// "Order".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sampledb/codec/big_buffer.h"
#include "sampledb/codec/sorter_row.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"
#include "sampledb/data/record.h"

namespace latent::sampledb {

// Row numbers in ascending order of sample, rows of one sample as they came; empty if they are in that order already.
std::vector<std::uint32_t> order_by_sample(const Records& records);

// Sorts the rows of one run after another; its memory (about 35 bytes per record) is kept for the next.
class RowSorter {
 public:
    // Forgets the last run. At most `rows` rows will be added.
    void begin(const Job& job, std::size_t rows);
    // Records that fit the job, in any order; their samples come after those of earlier pieces. They are copied.
    void add(const Records& piece);

    std::size_t count(RecordClass record_class) const { return count_[static_cast<std::size_t>(record_class)]; }
    // Z prefixes of the rows of a class from the `begin`th on, ascending: `most` of them at least, or all. Neither class nor begin
    // go back: what lies before is forgotten.
    std::span<const std::uint32_t> z(RecordClass record_class, std::size_t begin, std::size_t most);
    // Copies rows begin .. end-1 of a class, in canonical order, into the columns of a page; they are among those that z() gave.
    void gather(RecordClass record_class, std::size_t begin, std::size_t end, Page& page) const;

 private:
    // Rows go to buckets by class and the leading bits of z. A bucket is a list of chunks. Low-discrepancy positions fill all
    // buckets at the same pace: a chunk is an odd number of cache lines, so that the ends of the buckets fall on different sets
    // of the cache.
    static constexpr int kBucketBits = 8;  // bits of z: a bucket of a large run fits the second-level cache
    static constexpr std::size_t kBuckets = std::size_t{1} << kBucketBits;
    static constexpr std::uint32_t kChunk = 66;
    struct Bucket {
        std::uint32_t next = 0, end = 0;  // places in rows_: of the next row, of the end of the last chunk
        std::uint32_t chunks = 0, first_chunk = 0, last_chunk = 0;
        std::size_t count() const { return std::size_t{chunks} * kChunk - (end - next); }
    };

    using Row = SorterRow;

    // Calls f<kind, density>() with those of the job.
    template <class F>
    void with_layout(F&& f) const;
    template <RecordKind kind, bool density>
    void load_rows(const Records& piece, std::span<const std::uint32_t> by_sample, std::size_t first, std::span<Row> rows) const;
    template <RecordKind kind, bool density>
    void gather_rows(std::span<const std::uint32_t> places, Page& page) const;
    void add_chunk(Bucket& bucket);
    void sort_bucket(const Bucket& bucket);

    std::size_t first_row(RecordClass record_class) const { return record_class == RecordClass::kCamera ? 0 : count_[0]; }

    const Job* job_ = nullptr;
    std::array<Bucket, 2 * kBuckets> buckets_{};  // camera, then light, by the leading bits of z
    std::array<std::size_t, 2> count_{};          // by class
    std::uint32_t chunks_ = 0;                    // in use
    BigBuffer<std::uint32_t> next_chunk_;         // the next one of the same bucket
    BigBuffer<Row> rows_;                         // by chunk
    BigBuffer<std::uint32_t> sources_;            // where each row stands in came_.extra; only if there are extra columns
    Columns came_;                                // columns of pairs, and extra ones, as they came
    std::vector<std::uint32_t> first_pair_;       // in a piece

    std::size_t sorted_buckets_ = 0;            // buckets before this one are in order
    std::size_t first_rank_ = 0;                // where what follows begins
    std::vector<std::uint32_t> z_, order_;      // by rank: Z prefix, place in rows_
    std::vector<std::uint64_t> keys_, sorted_;  // those of a bucket
};

}  // namespace latent::sampledb
