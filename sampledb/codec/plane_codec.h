// sampledb/codec/plane_codec.h: how one byte plane is stored. docs/format.md, "Page".
#pragma once

#include <cstdint>

#include "base/bytes.h"
#include "base/result.h"

namespace latent::sampledb {

enum class PlaneCodec : std::uint8_t { kRaw = 0, kZstd = 1, kConstant = 2, kDictionary = 3 };

// How a plane is stored, as one word of a page's table: codec in the two high bits, stored bytes below.
struct PlaneEntry {
    PlaneCodec codec = PlaneCodec::kRaw;
    std::uint32_t stored_size = 0;

    std::uint32_t word() const { return static_cast<std::uint32_t>(codec) << 30 | stored_size; }
    static PlaneEntry from_word(std::uint32_t word) { return {static_cast<PlaneCodec>(word >> 30), word & 0x3FFFFFFF}; }
};

// Appends the plane to `out`, by a codec that makes it small at little cost to write and to read.
PlaneEntry encode_plane(ByteSpan plane, Bytes& out);
// The plane's `size` bytes: in `stored` itself where they stand there as they are, else decoded into `scratch`. Errors: kCorrupt.
Result<ByteSpan> decode_plane(PlaneEntry entry, ByteSpan stored, std::size_t size, Bytes& scratch);

}  // namespace latent::sampledb
