// Planes and bits come back as they went in; stored planes that mislead are refused.
#include "sampledb/planes.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <array>
#include <random>

namespace latent::sampledb {
namespace {

Bytes noise(std::size_t size, unsigned values, unsigned seed) {
    std::mt19937 random(seed);
    Bytes bytes(size);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random() % values);
    return bytes;
}

TEST(Planes, JoinIsTheReverseOfSplit) {
    for (const std::size_t width : {1u, 2u, 4u, 8u}) {
        for (const std::size_t count : {0u, 1u, 15u, 16u, 17u, 100u, 4096u}) {
            const Bytes values = noise(width * count, 256, 1);
            Bytes planes(values.size()), joined(values.size());
            split_planes(values, width, planes);
            std::array<ByteSpan, 8> parts;
            for (std::size_t p = 0; p < width; ++p) {
                parts[p] = ByteSpan(planes).subspan(p * count, count);
                for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(parts[p][i], values[i * width + p]);
            }
            join_planes(std::span(parts).first(width), joined);
            EXPECT_TRUE(joined == values);
        }
    }
}

TEST(Planes, BitsComeBackAtEveryWidth) {
    std::mt19937_64 random(2);
    for (unsigned bits = 0; bits <= 64; ++bits) {
        for (const std::size_t count : {0u, 1u, 2u, 7u, 8u, 9u, 100u}) {
            std::vector<std::uint64_t> values(count), back(count, 1);
            for (std::uint64_t& value : values) value = bits == 0 ? 0 : random() >> (64 - bits);
            Bytes packed;
            pack_bits(values, bits, packed);
            ASSERT_EQ(packed.size(), packed_size(count, bits));
            for (std::size_t i = 0; i < count * bits; ++i) {  // the low bit of the first byte first
                const bool bit = (static_cast<unsigned>(packed[i / 8]) >> (i % 8) & 1) != 0;
                ASSERT_EQ(bit, (values[i / bits] >> (i % bits) & 1) != 0);
            }
            unpack_bits(packed, bits, back);
            ASSERT_EQ(back, values) << bits;
        }
    }
}

TEST(Planes, EveryCodecComesBackAndIsUsedWhereItPays) {
    const auto codec_of = [](const Bytes& plane) {
        Bytes stored, scratch;
        const PlaneEntry entry = encode_plane(plane, stored);
        EXPECT_EQ(entry.stored_size, stored.size());
        EXPECT_EQ(PlaneEntry::from_word(entry.word()).codec, entry.codec);
        const Result<ByteSpan> back = decode_plane(entry, stored, plane.size(), scratch);
        EXPECT_TRUE(back && std::ranges::equal(*back, plane));
        EXPECT_LE(stored.size(), plane.size());
        return entry.codec;
    };
    EXPECT_EQ(codec_of(Bytes(5000, std::byte{7})), PlaneCodec::kConstant);
    EXPECT_EQ(codec_of(Bytes(1, std::byte{7})), PlaneCodec::kConstant);
    EXPECT_EQ(codec_of(noise(5000, 256, 1)), PlaneCodec::kRaw);
    EXPECT_EQ(codec_of(noise(20, 2, 1)), PlaneCodec::kRaw);
    EXPECT_EQ(codec_of(noise(5000, 16, 1)), PlaneCodec::kZstd);
    // Noise of which a share p is black has an entropy of H(p) + 8 (1 - p) bits: 4 % less at p = 0.1, 28 % at 0.4.
    const auto with_black = [](std::size_t blacks_of_ten) {
        Bytes plane = noise(5000, 256, 2);
        for (std::size_t i = 0; i < plane.size(); ++i) {
            if (i * 7 % 10 < blacks_of_ten) plane[i] = std::byte{0};
        }
        return plane;
    };
    EXPECT_EQ(codec_of(with_black(1)), PlaneCodec::kRaw);
    EXPECT_EQ(codec_of(with_black(4)), PlaneCodec::kZstd);
}

TEST(Planes, StoredPlanesThatMisleadAreRefused) {
    const Bytes plane = noise(5000, 4, 3);
    Bytes frame, scratch;
    const PlaneEntry entry = encode_plane(plane, frame);
    ASSERT_EQ(entry.codec, PlaneCodec::kZstd);
    const auto refused = [&](PlaneCodec codec, const Bytes& stored, std::size_t size) {
        return !decode_plane({codec, static_cast<std::uint32_t>(stored.size())}, stored, size, scratch);
    };
    EXPECT_FALSE(refused(PlaneCodec::kZstd, frame, 5000));
    EXPECT_TRUE(refused(PlaneCodec::kZstd, frame, 4999));  // decodes to more than the column holds
    EXPECT_TRUE(refused(PlaneCodec::kZstd, frame, 5001));  // or to less
    Bytes twice = frame;
    twice.insert(twice.end(), frame.begin(), frame.end());
    EXPECT_TRUE(refused(PlaneCodec::kZstd, twice, 10000));  // two frames
    Bytes longer = frame;
    longer.push_back(std::byte{0});
    EXPECT_TRUE(refused(PlaneCodec::kZstd, longer, 5000));
    Bytes shorter = frame;
    shorter.pop_back();
    EXPECT_TRUE(refused(PlaneCodec::kZstd, shorter, 5000));
    EXPECT_TRUE(refused(PlaneCodec::kZstd, {}, 5000));
    Bytes skippable(12);
    store_le(skippable.data(), std::uint32_t{0x184D2A50});
    store_le(skippable.data() + 4, std::uint32_t{4});
    EXPECT_TRUE(refused(PlaneCodec::kZstd, skippable, 0));
    // 16 MiB of zeros in a few hundred bytes, for a plane that says 100
    const Bytes zeros(std::size_t{16} << 20);
    Bytes bomb(ZSTD_compressBound(zeros.size()));
    bomb.resize(ZSTD_compress(bomb.data(), bomb.size(), zeros.data(), zeros.size(), 1));
    EXPECT_TRUE(refused(PlaneCodec::kZstd, bomb, 100));
    EXPECT_LE(scratch.size(), 10000u);
    EXPECT_TRUE(refused(PlaneCodec::kRaw, plane, 4999));
    EXPECT_TRUE(refused(PlaneCodec::kConstant, Bytes(2), 100));
    EXPECT_TRUE(refused(static_cast<PlaneCodec>(3), plane, 5000));
}

}  // namespace
}  // namespace latent::sampledb
