// sampledb/data/record.h: records in memory, as columns. What a renderer emits, a page decodes to, and a darkroom weighs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sampledb/data/columns.h"

namespace latent::sampledb {

inline constexpr std::uint16_t kMaxPairs = 1024;   // pairs of one spectral record
inline constexpr std::uint16_t kNoIndex = 0xFFFF;  // the record keeps its whole batch, or nothing

// Records as columns; every column that applies has `size()` rows, the others are empty.
struct Records : Columns {
    std::vector<RecordClass> record_class;

    std::size_t size() const { return sample.size(); }
    bool empty() const { return sample.empty(); }
    void clear();
    Records without_rows() const;  // the same extra columns, empty
    // Appends row `row` of `from`, whose pairs begin at `first_pair` of its power column. Same kind, same extra columns.
    void append(const Records& from, std::size_t row, std::size_t first_pair);
    // Bytes that the rows take in these columns.
    std::uint64_t raw_bytes() const;
};

}  // namespace latent::sampledb
