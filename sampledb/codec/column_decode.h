// sampledb/codec/column_decode.h: the stored planes of one column -> its values, by each transform. docs/format.md, "Page".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "sampledb/codec/page_layout.h"

namespace latent::sampledb {

// All fill `values`; entry.stored holds the column's planes. Errors: kCorrupt, kUnsupported (a transform that does not fit).

// Byte planes, or a constant.
Status decode_plain(const ColumnEntry& entry, std::span<std::byte> values, std::size_t value_width);
// Sample numbers: packed, or on the lattice.
Status decode_samples(const ColumnEntry& entry, std::span<std::uint64_t> values);
// The rows of a page where y is not zero, if y says so.
struct BrightRows {
    bool known = false;
    Bytes bitmap;  // bit i mod 8 of byte i / 8: row i
    std::size_t count = 0;
    std::vector<std::uint32_t> y;  // their bits; longer
};
// y, and its bright rows.
Status decode_y(const ColumnEntry& entry, std::span<float> values, BrightRows& bright);
// x and z by their difference to y, whose rows `y` and `bright` are.
Status decode_crossed(const ColumnEntry& entry, std::span<float> values, std::span<const float> y, const BrightRows& bright);
// power and lambda by second differences along each record of `pairs` values, which add up to values.size().
Status decode_delta2(const ColumnEntry& entry, std::span<float> values, std::span<const std::uint16_t> pairs);

}  // namespace latent::sampledb
