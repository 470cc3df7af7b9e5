#include "image/deflate.h"

#include <zlib.h>

#include <cassert>
#include <memory>
#include <new>

namespace latent::image {

namespace {

const Bytef* zlib_bytes(ByteSpan bytes) { return reinterpret_cast<const Bytef*>(bytes.data()); }

// Pieces are some megabytes at most: they fit zlib's 32-bit counts.
Bytes compress(ByteSpan raw, int level, int window_bits, int flush) {
    z_stream stream{};
    if (deflateInit2(&stream, level, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
    const std::unique_ptr<z_stream, decltype(&deflateEnd)> owner(&stream, deflateEnd);
    assert(raw.size() < (std::size_t{1} << 31));
    Bytes out(deflateBound(&stream, raw.size()) + 16);  // 16: the empty block of a sync flush
    stream.next_in = const_cast<Bytef*>(zlib_bytes(raw));
    stream.avail_in = static_cast<uInt>(raw.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, flush);
    assert(stream.avail_in == 0 && stream.avail_out > 0);
    out.resize(stream.total_out);
    return out;
}

}  // namespace

DeflatePiece deflate_piece(ByteSpan raw, int level, bool last) {
    DeflatePiece piece;
    piece.bytes = compress(raw, level, -15, last ? Z_FINISH : Z_SYNC_FLUSH);
    piece.adler = static_cast<std::uint32_t>(adler32_z(1, zlib_bytes(raw), raw.size()));
    piece.raw_size = raw.size();
    return piece;
}

// 0x78: deflate with a 32 KiB window; 0x01: fastest, no dictionary; a multiple of 31 together [RFC1950].
Bytes zlib_header() { return {std::byte{0x78}, std::byte{0x01}}; }

Bytes zlib_trailer(std::uint32_t adler) {
    return {std::byte(adler >> 24), std::byte(adler >> 16 & 0xff), std::byte(adler >> 8 & 0xff), std::byte(adler & 0xff)};
}

std::uint32_t joined_adler(std::uint32_t first, const DeflatePiece& second) {
    return static_cast<std::uint32_t>(adler32_combine(first, second.adler, static_cast<z_off_t>(second.raw_size)));
}

Bytes zlib_stream(ByteSpan raw, int level) { return compress(raw, level, 15, Z_FINISH); }

}  // namespace latent::image
