// sampledb/column_decode.h: the stored planes of one column -> its values, by each transform. docs/format.md, "Page".
#pragma once

#include <cstdint>
#include <span>

#include "base/result.h"
#include "sampledb/page_layout.h"

namespace latent::sampledb {

// All fill `values`; entry.stored holds the column's planes. Errors: kCorrupt, kUnsupported (a transform that does not fit).

// Byte planes, or a constant.
Status decode_plain(const ColumnEntry& entry, std::span<std::byte> values, std::size_t value_width);
// Sample numbers: packed, or on the lattice.
Status decode_samples(const ColumnEntry& entry, std::span<std::uint64_t> values);
// x and z by their difference to y.
Status decode_crossed(const ColumnEntry& entry, std::span<float> values, std::span<const float> y);
// power and lambda by second differences along each record of `pairs` values, which add up to values.size().
Status decode_delta2(const ColumnEntry& entry, std::span<float> values, std::span<const std::uint16_t> pairs);

}  // namespace latent::sampledb
