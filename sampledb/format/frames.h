// sampledb/format/frames.h: what the three kinds of frame (file header, run, footer) share. docs/format.md, first section.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "base/bytes.h"
#include "base/hash.h"
#include "base/result.h"
#include "sampledb/data/unreadable.h"

namespace latent::sampledb {

inline constexpr std::uint64_t kBlock = 4096;  // headers, runs and the footer begin at multiples of it

// A byte that is no text, what follows, and a line end that text-mode transfers would break.
using Magic = std::array<unsigned char, 8>;
inline constexpr Magic kFileMagic = {0x8D, 'L', 'T', 'D', 'B', 'F', '\r', '\n'};
inline constexpr Magic kRunMagic = {0x8D, 'L', 'T', 'D', 'B', 'R', '\r', '\n'};
inline constexpr Magic kFooterMagic = {0x8D, 'L', 'T', 'D', 'B', 'I', '\r', '\n'};
inline constexpr Magic kFirstFooterMagic = {0x8D, 'L', 'T', 'D', 'B', 'E', '\r', '\n'};  // as version 0.1 wrote it
inline constexpr std::uint16_t kMajor = 1;
inline constexpr std::uint16_t kHeaderMinor = 2;       // the highest that this program writes and knows
inline constexpr std::uint64_t kFooterFeature = 2;     // in a header: the footer has its second form, which 0.1.0 takes for damage
inline constexpr std::uint64_t kPrecisionFeature = 1;  // in a header: its field `precision` is below 23
inline constexpr std::uint64_t kManyColumnsFeature = 4;  // in a header: it has more than 16 extra columns
inline constexpr std::uint64_t kPixelsFeature = 8;       // in a header: samples lie by PositionSampler::kPixels

inline ByteSpan bytes_of(const Magic& magic) { return std::as_bytes(std::span(magic)); }
bool begins_with(ByteSpan bytes, const Magic& magic);
bool all_zero(ByteSpan bytes);

constexpr std::uint64_t round_up_to_block(std::uint64_t size) { return (size + kBlock - 1) / kBlock * kBlock; }

// Errors: kUnsupported if the format is one that this program cannot read. `known`: the features that it knows.
Status check_version(std::uint16_t major, std::uint64_t features, std::uint64_t known);

void put_hash(ByteWriter& out, const Hash128& hash);
Hash128 get_hash(ByteReader& in);
std::string get_text(ByteReader& in, std::size_t size);

}  // namespace latent::sampledb
