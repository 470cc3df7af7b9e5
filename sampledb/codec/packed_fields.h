// sampledb/codec/packed_fields.h: up to 128 numbers in fields of equal width, four beside each other. docs/format.md, "Packed
// delta2".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace latent::sampledb {

inline constexpr std::size_t kFieldsPerBlock = 128;
inline constexpr unsigned kMaxFieldBits = 24;
using FieldBlock = std::array<std::uint32_t, kFieldsPerBlock>;

// Bytes of n fields.
constexpr std::size_t packed_fields_size(std::size_t n, unsigned bits) {
    return (((n + 3) / 4) * bits + 31) / 32 * 4 * sizeof(std::uint32_t);
}

// Writes packed_fields_size(n, bits) bytes. Fields are below 2^bits; those from n on are zero.
void pack_fields(const FieldBlock& fields, std::size_t n, unsigned bits, std::byte* to);

// Reads as many; `bits` is at most kMaxFieldBits. What is in `fields` from n on is undefined.
void unpack_fields(const std::byte* from, std::size_t n, unsigned bits, FieldBlock& fields);

}  // namespace latent::sampledb
