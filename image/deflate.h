// image/deflate.h: zlib streams, whole or as pieces that many threads compress and that join into one.
#pragma once

#include <cstdint>

#include "base/bytes.h"

namespace latent::image {

// A piece of one zlib stream: raw deflate blocks that end on a byte boundary, and the checksum of what they hold.
struct DeflatePiece {
    Bytes bytes;
    std::uint32_t adler = 1;   // Adler-32 of the piece's own uncompressed bytes
    std::size_t raw_size = 0;  // how many these are
};

// Compresses one piece (zlib level 1..9); the `last` one ends the stream, the others end with an empty block (Z_SYNC_FLUSH).
DeflatePiece deflate_piece(ByteSpan raw, int level, bool last);

// The two bytes before the first piece, and the checksum behind the last.
Bytes zlib_header();
Bytes zlib_trailer(std::uint32_t adler);
// Adler-32 of two pieces joined.
std::uint32_t joined_adler(std::uint32_t first, const DeflatePiece& second);

// One whole zlib stream.
Bytes zlib_stream(ByteSpan raw, int level);

}  // namespace latent::image
