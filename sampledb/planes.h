// sampledb/planes.h: columns of numbers <-> byte planes, bit packing, and the codec of one plane. docs/format.md, "Page".
#pragma once

#include <cstdint>
#include <span>

#include "base/bytes.h"
#include "base/result.h"

namespace latent::sampledb {

enum class PlaneCodec : std::uint8_t { kRaw = 0, kZstd = 1, kConstant = 2 };

// How a plane is stored, as one word of a page's table: codec in the two high bits, stored bytes below.
struct PlaneEntry {
    PlaneCodec codec = PlaneCodec::kRaw;
    std::uint32_t stored_size = 0;

    std::uint32_t word() const { return static_cast<std::uint32_t>(codec) << 30 | stored_size; }
    static PlaneEntry from_word(std::uint32_t word) { return {static_cast<PlaneCodec>(word >> 30), word & 0x3FFFFFFF}; }
};

// Appends the plane to `out`, by the codec that makes it smallest at little cost.
PlaneEntry encode_plane(ByteSpan plane, Bytes& out);
// The plane's `size` bytes: in `stored` itself where they stand there as they are, else decoded into `scratch`.
// Errors: kCorrupt, kUnsupported.
Result<ByteSpan> decode_plane(PlaneEntry entry, ByteSpan stored, std::size_t size, Bytes& scratch);

// Byte p of value i becomes byte i of plane p (bytes p n .. p n + n - 1 of `planes`). Widths 1, 2, 4, 8.
void split_planes(ByteSpan values, std::size_t value_width, std::span<std::byte> planes);
// The reverse; planes[p] is plane p.
void join_planes(std::span<const ByteSpan> planes, std::span<std::byte> values);

// Values of `bits` bits each (0..64), one after another from the low bit of the first byte on.
std::size_t packed_size(std::size_t count, unsigned bits);
void pack_bits(std::span<const std::uint64_t> values, unsigned bits, Bytes& out);
// Reads packed_size(values.size(), bits) bytes.
void unpack_bits(ByteSpan packed, unsigned bits, std::span<std::uint64_t> values);

}  // namespace latent::sampledb
