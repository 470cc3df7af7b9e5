// Planes come back by every codec, each used where it pays; stored planes that mislead are refused.
#include "sampledb/codec/plane_codec.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>

#include "tests/sampledb/noise.h"

namespace latent::sampledb {
namespace {

TEST(PlaneCodec, EveryCodecComesBackAndIsUsedWhereItPays) {
    const auto codec_of = [](const Bytes& plane) {
        Bytes stored, scratch;
        const PlaneEntry entry = PlaneEncoder().encode(plane, stored);
        EXPECT_EQ(entry.stored_size, stored.size());
        EXPECT_EQ(PlaneEntry::from_word(entry.word()).codec, entry.codec);
        const Result<ByteSpan> back = PlaneDecoder().decode(entry, stored, plane.size(), scratch);
        EXPECT_TRUE(back && std::ranges::equal(*back, plane));
        EXPECT_LE(stored.size(), plane.size());
        return entry.codec;
    };
    EXPECT_EQ(codec_of(Bytes(5000, std::byte{7})), PlaneCodec::kConstant);
    EXPECT_EQ(codec_of(Bytes(1, std::byte{7})), PlaneCodec::kConstant);
    EXPECT_EQ(codec_of(noise(5000, 256, 1)), PlaneCodec::kRaw);
    EXPECT_EQ(codec_of(noise(20, 2, 1)), PlaneCodec::kRaw);
    for (const unsigned values : {2u, 3u, 4u, 7u, 16u, 25u, 100u}) {
        for (const std::size_t size : {4001u, 5000u, 5007u, 5008u}) {
            EXPECT_EQ(codec_of(noise(size, values, 1)), PlaneCodec::kDictionary) << values << " " << size;
        }
    }
    EXPECT_EQ(codec_of(noise(5000, 130, 1)), PlaneCodec::kZstd);  // no dictionary has 8 bits
    Bytes rare = noise(5000, 2, 1);
    for (std::size_t value = 2; value < 40; ++value) rare[value * 100] = static_cast<std::byte>(value);
    EXPECT_EQ(codec_of(rare), PlaneCodec::kZstd);  // 6 bits, where 1.1 are enough
    Bytes sorted = noise(5000, 64, 1);
    std::ranges::sort(sorted);
    EXPECT_EQ(codec_of(sorted), PlaneCodec::kZstd);
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

TEST(PlaneCodec, StoredPlanesThatMisleadAreRefused) {
    Bytes plane = noise(5000, 4, 3);
    std::ranges::sort(plane);
    Bytes frame, scratch;
    const PlaneEntry entry = PlaneEncoder().encode(plane, frame);
    ASSERT_EQ(entry.codec, PlaneCodec::kZstd);
    const auto refused = [&](PlaneCodec codec, const Bytes& stored, std::size_t size) {
        return !PlaneDecoder().decode({codec, static_cast<std::uint32_t>(stored.size())}, stored, size, scratch);
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
    EXPECT_LE(scratch.size(), 10100u);
    EXPECT_TRUE(refused(PlaneCodec::kRaw, plane, 4999));
    EXPECT_TRUE(refused(PlaneCodec::kConstant, Bytes(2), 100));

    Bytes dictionary;
    ASSERT_EQ(PlaneEncoder().encode(noise(5000, 4, 3), dictionary).codec, PlaneCodec::kDictionary);
    EXPECT_EQ(dictionary.size(), 1u + 4 + 5000 / 8 * 2);
    EXPECT_FALSE(refused(PlaneCodec::kDictionary, dictionary, 5000));
    EXPECT_FALSE(refused(PlaneCodec::kDictionary, dictionary, 4993));  // as many groups of eight
    EXPECT_TRUE(refused(PlaneCodec::kDictionary, dictionary, 4992));
    EXPECT_TRUE(refused(PlaneCodec::kDictionary, dictionary, 5001));
    EXPECT_TRUE(refused(PlaneCodec::kDictionary, {}, 5000));
    EXPECT_TRUE(refused(PlaneCodec::kDictionary, {}, 0));
    for (unsigned bits = 0; bits < 256; ++bits) {
        Bytes other = dictionary;
        other[0] = static_cast<std::byte>(bits);
        EXPECT_EQ(refused(PlaneCodec::kDictionary, other, 5000), bits != 2);
    }
}

}  // namespace
}  // namespace latent::sampledb
