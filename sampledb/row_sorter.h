// sampledb/row_sorter.h: the rows of a run in canonical order: class, Z prefix, sample, order of emission. docs/format.md, "Order".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sampledb/job.h"
#include "sampledb/page.h"
#include "sampledb/record.h"

namespace latent::sampledb {

// Row numbers in ascending order of sample, rows of one sample as they came; empty if they are in that order already.
std::vector<std::uint32_t> order_by_sample(const Records& records);

// Sorts the rows of one run after another; its memory (about 40 bytes per record) is kept for the next.
class RowSorter {
 public:
    // `records` fit the job, are fewer than 2^32, and stay as they are until all pages have been gathered.
    void sort(const Job& job, const Records& records);

    std::size_t count(RecordClass record_class) const;
    // Z prefixes of the rows of a class, ascending: the first `most` of them at least, or all.
    std::span<const std::uint32_t> z(RecordClass record_class, std::size_t most);
    // Copies rows begin .. end-1 of a class, in canonical order, into the columns of a page; they are among those that z() gave.
    void gather(RecordClass record_class, std::size_t begin, std::size_t end, Page& page) const;

 private:
    // The fixed columns of a record side by side, half a cache line: fetching a row in sorted order costs one miss, not eight.
    struct Row {
        std::uint64_t sample;
        std::uint32_t u, v;
        float share;
        union {
            struct {
                float x, y, z;
            } xyz;
            struct {
                std::uint32_t xi;
                std::uint16_t pairs, index;
                std::uint32_t first_pair;  // in the run
            } spectral;
        };
    };
    static_assert(sizeof(Row) == 32);

    static constexpr int kBucketBits = 8;  // of z: a bucket of a large run fits the second-level cache
    static constexpr std::size_t kBuckets = std::size_t{1} << kBucketBits;
    using Bounds = std::array<std::uint32_t, 2 * kBuckets + 1>;

    template <class RowAt>
    void load_rows(const RowAt& row_at, std::span<const std::uint32_t> first_pair, std::span<Row> rows) const;
    std::size_t slot(std::size_t bucket) const;
    void sort_bucket(std::size_t bucket);
    std::size_t first_row(RecordClass record_class) const;

    const Job* job_ = nullptr;
    const Records* records_ = nullptr;
    Bounds begin_{};                            // first rank of each bucket: camera, then light, by the leading bits of z
    std::size_t sorted_buckets_ = 0;            // buckets before this one are in order
    std::vector<Row> rows_;                     // by bucket
    std::vector<std::uint32_t> sources_;        // of each row, in `records`; only if there are extra columns
    std::vector<std::uint32_t> z_, order_;      // by rank: Z prefix, place in rows_
    std::vector<std::uint64_t> keys_, sorted_;  // of a bucket
};

}  // namespace latent::sampledb
