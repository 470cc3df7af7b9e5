// sampledb/codec/planes.h: columns of numbers <-> byte planes, packed bits, rows without the zeros. docs/format.md, "Page".
#pragma once

#include <cstdint>
#include <span>

#include "base/bytes.h"

namespace latent::sampledb {

// Byte p of value i becomes byte i of plane p (bytes p n .. p n + n - 1 of `planes`). Widths 1, 2, 4, 8.
void split_planes(ByteSpan values, std::size_t value_width, std::span<std::byte> planes);
// The reverse; planes[p] is plane p, or one byte that stands for all of its bytes.
void join_planes(std::span<const ByteSpan> planes, std::span<std::byte> values);

// Values of `bits` bits each (0..64), one after another from the low bit of the first byte on.
std::size_t packed_size(std::size_t count, unsigned bits);
void pack_bits(std::span<const std::uint64_t> values, unsigned bits, Bytes& out);
// Reads packed_size(values.size(), bits) bytes.
void unpack_bits(ByteSpan packed, unsigned bits, std::span<std::uint64_t> values);

// Which of the values, of four bytes, are not zero, as bit i mod 8 of byte i / 8 of `bitmap`, which is replaced. Returns how many.
std::size_t find_nonzero(ByteSpan values, Bytes& bitmap);
// Moves the values whose bits are set to the front. What is behind them is undefined.
void compress(ByteSpan bitmap, std::span<std::uint32_t> values);
// The reverse: value i, of four bytes, is the next of `nonzero` where bit i is set, else 0. Behind the values to take,
// kExpandPadding more may be read.
constexpr std::size_t kExpandPadding = 4;
void expand(ByteSpan bitmap, const std::uint32_t* nonzero, std::span<std::byte> values);

}  // namespace latent::sampledb
