// sampledb/row_sorter.h: the rows of a run in canonical order: class, Z prefix, sample, order of emission. docs/format.md, "Order".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sampledb/job.h"
#include "sampledb/page.h"
#include "sampledb/record.h"

namespace latent::sampledb {

// Row numbers in ascending order of sample, rows of one sample as they came; empty if they are in that order already.
std::vector<std::uint32_t> order_by_sample(const Records& records);

// Sorts the rows of one run after another; its memory (about 56 bytes per record) is kept for the next.
class RowSorter {
 public:
    // `records` fit the job, are fewer than 2^32, and stay as they are until all pages have been gathered.
    void sort(const Job& job, const Records& records);

    // Z prefixes of the rows of a class, ascending.
    std::span<const std::uint32_t> z(RecordClass record_class) const;
    // Copies rows begin .. end-1 of a class, in canonical order, into the columns of a page.
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

    void partition(const std::vector<std::uint32_t>& by_sample);
    template <class RowAt>
    void load_rows(const RowAt& row_at, std::span<const std::uint32_t> first_pair, std::span<Row> rows) const;
    // Sorts keys_[slot, slot + end - begin) into ranks begin .. end-1 of z_ and order_.
    void sort_bucket(std::size_t begin, std::size_t end, std::size_t slot);
    std::span<const std::uint32_t> order(RecordClass record_class) const;

    const Job* job_ = nullptr;
    const Records* records_ = nullptr;
    std::vector<Row> rows_;                     // by class and the leading bits of z
    std::vector<std::uint32_t> sources_;        // of each row, in `records`; only if there are extra columns
    std::vector<std::uint64_t> keys_, sorted_;  // Z prefix above, row below
    std::vector<std::uint32_t> z_, order_;
    std::size_t camera_count_ = 0;
};

}  // namespace latent::sampledb
