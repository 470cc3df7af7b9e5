// sampledb/codec/column_decode.h: the stored planes of one column -> its values, by each transform. docs/format.md, "Page".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "sampledb/codec/packed_delta2.h"
#include "sampledb/codec/page_layout.h"

namespace latent::sampledb {

// The rows of a page where y is not zero, if y says so.
struct BrightRows {
    bool known = false;
    Bytes bitmap;  // bit i mod 8 of byte i / 8: row i
    std::size_t count = 0;
    std::vector<std::uint32_t> y;  // their bits; longer
};

// Keeps its memory from column to column; serves one thread at a time. All fill `values`; entry.stored holds the column's planes.
// Errors: kCorrupt, kUnsupported (a transform that does not fit).
class ColumnDecoder {
 public:
    // Byte planes, or a constant.
    Status plain(const ColumnEntry& entry, std::span<std::byte> values, std::size_t value_width);
    // Sample numbers: packed, or on the lattice.
    Status samples(const ColumnEntry& entry, std::span<std::uint64_t> values);
    // The numbers in the fields of a packed column, without its base.
    Status packed(const ColumnEntry& entry, std::span<std::uint64_t> values);
    // y, and its bright rows.
    Status luminance(const ColumnEntry& entry, std::span<float> values, BrightRows& bright);
    // x and z by their difference to y, whose rows `y` and `bright` are.
    Status crossed(const ColumnEntry& entry, std::span<float> values, std::span<const float> y, const BrightRows& bright);
    // power and lambda by second differences along each record of `pairs` values, at most k, which add up to values.size().
    Status along_records(const ColumnEntry& entry, std::span<float> values, std::span<const std::uint16_t> pairs, std::size_t k);

    // The planes of a column in packed fields. They are good until the next call.
    using PackedPlanes = std::array<ByteSpan, kDelta2Planes>;
    Result<PackedPlanes> packed_planes(const ColumnEntry& entry, const Delta2Blocks& blocks);

 private:
    // Joins a column's byte planes, those from `first` on, into `values`. `stored` begins with them.
    Status load_planes(const ColumnEntry& entry, std::size_t first, ByteSpan stored, std::span<std::byte> values,
                       std::size_t value_width);

    PlaneDecoder planes_;
    std::array<Bytes, kMaxPlanes> plane_;
    std::vector<std::uint32_t> words_;
    Delta2Unpacker delta2_;
};

}  // namespace latent::sampledb
