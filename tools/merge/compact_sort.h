// tools/merge/compact_sort.h: sorted stretches of rows become one, in parallel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tools/merge/compact_front.h"
#include "tools/merge/compact_rows.h"

namespace latent::merge {

// Rows begin .. end-1 of a page, ascending by key.
struct Slice {
    const DecodedPage* rows;
    std::uint32_t page;  // in the PageTable
    std::size_t begin, end;
};

inline std::size_t rows_of(std::span<const Slice> slices) {
    std::size_t rows = 0;
    for (const Slice& slice : slices) rows += slice.end - slice.begin;
    return rows;
}

// Puts the rows of all slices, ascending by (Z prefix, sample), into `z` and `order`, which have room for just them. Of equal ones
// those of an earlier slice come first. Runs on the threads of the arena that it is called in.
void merge_slices(std::span<const Slice> slices, std::span<std::uint32_t> z, std::span<RowRef> order);

}  // namespace latent::merge
