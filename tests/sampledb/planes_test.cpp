// Planes, bits and rows come back as they went in.
#include "sampledb/codec/planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <random>

#include "tests/sampledb/noise.h"

namespace latent::sampledb {
namespace {

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

TEST(Planes, OneByteStandsForAPlaneOfEqualBytes) {
    const Bytes byte = {std::byte{0x5A}};
    for (const std::size_t width : {1u, 2u, 4u, 8u}) {
        for (const std::size_t count : {2u, 15u, 16u, 17u, 100u}) {
            for (unsigned constant = 0; constant < 1u << width; ++constant) {  // the planes that are
                const Bytes planes = noise(width * count, 256, 1), whole(count, byte[0]);
                std::array<ByteSpan, 8> parts, all;
                for (std::size_t p = 0; p < width; ++p) {
                    const bool equal = (constant >> p & 1) != 0;
                    all[p] = equal ? ByteSpan(whole) : ByteSpan(planes).subspan(p * count, count);
                    parts[p] = equal ? ByteSpan(byte) : all[p];
                }
                Bytes values(width * count), joined(width * count);
                for (std::size_t i = 0; i < values.size(); ++i) values[i] = all[i % width][i / width];
                join_planes(std::span(parts).first(width), joined);
                EXPECT_TRUE(joined == values) << width << ' ' << count << ' ' << constant;
            }
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

TEST(Planes, RowsWithoutTheZerosComeBack) {
    std::mt19937 random(3);
    for (const unsigned zeros_of_eight : {0u, 1u, 4u, 7u, 8u}) {
        for (const std::size_t count : {1u, 2u, 3u, 4u, 5u, 7u, 8u, 9u, 63u, 64u, 65u, 1000u}) {
            std::vector<std::uint32_t> values(count), nonzero, back(count, 1);
            for (std::uint32_t& value : values)
                value = random() % 8 < zeros_of_eight ? 0 : static_cast<std::uint32_t>(random() | 1);
            std::ranges::copy_if(values, std::back_inserter(nonzero), [](std::uint32_t value) { return value != 0; });
            Bytes bitmap;
            ASSERT_EQ(find_nonzero(std::as_bytes(std::span(values)), bitmap), nonzero.size());
            ASSERT_EQ(bitmap.size(), (count + 7) / 8);
            for (std::size_t i = 0; i < 8 * bitmap.size(); ++i) {
                const bool bit = (std::to_integer<unsigned>(bitmap[i / 8]) >> (i % 8) & 1) != 0;
                ASSERT_EQ(bit, i < count && values[i] != 0);
            }
            std::vector<std::uint32_t> together = values;
            compress(bitmap, together);
            EXPECT_TRUE(std::equal(nonzero.begin(), nonzero.end(), together.begin()));
            nonzero.resize(nonzero.size() + kExpandPadding, 0xFFFFFFFF);
            expand(bitmap, nonzero.data(), std::as_writable_bytes(std::span(back)));
            EXPECT_EQ(back, values);
        }
    }
}

}  // namespace
}  // namespace latent::sampledb
