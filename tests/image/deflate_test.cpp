#include "image/deflate.h"

#include <gtest/gtest.h>
#include <zlib.h>

namespace latent::image {
namespace {

Bytes inflated(ByteSpan stream, std::size_t size) {
    Bytes out(size);
    uLongf length = size;
    EXPECT_EQ(
        uncompress(reinterpret_cast<Bytef*>(out.data()), &length, reinterpret_cast<const Bytef*>(stream.data()), stream.size()),
        Z_OK);
    EXPECT_EQ(length, size);
    return out;
}

TEST(Deflate, PiecesCompressedApartAreOneStreamTogether) {
    Bytes raw(100000);
    for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = std::byte(i * i >> 7 & 0xff);
    for (const std::size_t piece : {std::size_t{1}, std::size_t{999}, std::size_t{50000}, raw.size()}) {
        if (piece == 1) raw.resize(1000);
        Bytes stream = zlib_header();
        std::uint32_t adler = 1;
        for (std::size_t at = 0; at < raw.size(); at += piece) {
            const std::size_t size = std::min(piece, raw.size() - at);
            const DeflatePiece one = deflate_piece(ByteSpan(raw).subspan(at, size), 1, at + size == raw.size());
            stream.insert(stream.end(), one.bytes.begin(), one.bytes.end());
            adler = joined_adler(adler, one);
        }
        const Bytes trailer = zlib_trailer(adler);
        stream.insert(stream.end(), trailer.begin(), trailer.end());
        EXPECT_EQ(inflated(stream, raw.size()), raw) << "pieces of " << piece;
        if (piece == 1) raw.resize(100000);
    }
    EXPECT_EQ(inflated(zlib_stream(raw, 6), raw.size()), raw);
}

}  // namespace
}  // namespace latent::image
