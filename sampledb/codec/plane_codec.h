// sampledb/codec/plane_codec.h: how one byte plane is stored. docs/format.md, "Page".
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "base/bytes.h"
#include "base/result.h"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace latent::sampledb {

enum class PlaneCodec : std::uint8_t { kRaw = 0, kZstd = 1, kConstant = 2, kDictionary = 3 };

// How a plane is stored, as one word of a page's table: codec in the two high bits, stored bytes below.
struct PlaneEntry {
    PlaneCodec codec = PlaneCodec::kRaw;
    std::uint32_t stored_size = 0;

    std::uint32_t word() const { return static_cast<std::uint32_t>(codec) << 30 | stored_size; }
    static PlaneEntry from_word(std::uint32_t word) { return {static_cast<PlaneCodec>(word >> 30), word & 0x3FFFFFFF}; }
};

// What the encoder gives for speed. An entropy coder takes fewer bits than a dictionary, and much longer to read.
struct PlaneChoice {
    unsigned max_waste;  // what a dictionary may waste, in quarter bits per value
    unsigned min_gain;   // an entropy coder must save one part of so many
};
inline constexpr PlaneChoice kSmallPlanes{3, 16}, kQuickPlanes{10, 6};

// Both keep their memory from plane to plane; each serves one thread at a time.

class PlaneEncoder {
 public:
    // Appends the plane to `out`, by a codec that makes it small at little cost to write and to read.
    PlaneEntry encode(ByteSpan plane, Bytes& out, const PlaneChoice& choice = kSmallPlanes);
    // Appends the plane as it is.
    static PlaneEntry encode_raw(ByteSpan plane, Bytes& out);
    // About how many bytes `encode` would take, from the entropy of a sample.
    static std::size_t estimate(ByteSpan plane);

 private:
    std::size_t compress(ByteSpan plane);  // into buffer_; 0 if zstd makes it no smaller

    std::unique_ptr<ZSTD_CCtx_s, std::size_t (*)(ZSTD_CCtx_s*)> zstd_{nullptr, nullptr};  // made when it is first needed
    Bytes buffer_;
};

class PlaneDecoder {
 public:
    // The plane's `size` bytes: in `stored` itself where they stand there as they are, else decoded into `scratch`. Errors:
    // kCorrupt.
    Result<ByteSpan> decode(PlaneEntry entry, ByteSpan stored, std::size_t size, Bytes& scratch);

 private:
    bool decompress(ByteSpan stored, std::span<std::byte> plane);

    std::unique_ptr<ZSTD_DCtx_s, std::size_t (*)(ZSTD_DCtx_s*)> zstd_{nullptr, nullptr};  // made when it is first needed
};

}  // namespace latent::sampledb
