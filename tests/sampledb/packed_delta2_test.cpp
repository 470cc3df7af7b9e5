// Second differences in packed fields come back to the bit, whatever they are; what cannot be is refused. docs/format.md, "Packed
// delta2".
#include "sampledb/codec/packed_delta2.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <random>

#include "sampledb/codec/page_decoder.h"
#include "sampledb/codec/page_encoder.h"
#include "sampledb/codec/run_codec.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

using Pairs = std::vector<std::uint16_t>;

std::array<ByteSpan, kDelta2Planes> spans_of(const std::array<Bytes, kDelta2Planes>& planes) {
    std::array<ByteSpan, kDelta2Planes> spans;
    std::ranges::copy(planes, spans.begin());
    return spans;
}

std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
    std::vector<std::uint32_t> bits;
    for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
    return bits;
}

// The values after packing and unpacking.
std::vector<std::uint32_t> packed_and_back(const std::vector<float>& values, const Pairs& pairs, std::size_t k, unsigned step) {
    static Delta2Packer packer;  // of other columns before
    static Delta2Unpacker unpacker;
    packer.pack(values, pairs, k, step);
    const Delta2Blocks blocks(pairs, k);
    const auto planes = spans_of(packer.planes());
    const auto sizes = Delta2Unpacker::sizes(blocks, planes[kWidths], planes[kCounts]);
    EXPECT_TRUE(sizes);
    EXPECT_EQ(sizes->fields, planes[kFields].size());
    EXPECT_EQ(sizes->exceptions, planes[kPositions].size());
    std::vector<float> back(values.size(), -1.0f);
    const Status unpacked = unpacker.unpack(blocks, planes, pairs, step, back);
    EXPECT_TRUE(unpacked);
    return bits_of(back);
}

TEST(PackedDelta2, FieldsOfEveryWidthAndNumberAreReadBack) {
    std::mt19937 random(1);
    for (unsigned bits = 0; bits <= kMaxFieldBits; ++bits) {
        for (std::size_t n = 1; n <= kFieldsPerBlock; ++n) {
            FieldBlock fields{}, back;
            for (std::size_t i = 0; i < n; ++i) fields[i] = random() & ((1u << bits) - 1);
            Bytes packed(packed_fields_size(n, bits) + 1, std::byte{0xA5});
            pack_fields(fields, n, bits, packed.data());
            ASSERT_EQ(packed.back(), std::byte{0xA5}) << bits << " bits, " << n;
            unpack_fields(packed.data(), n, bits, back);
            ASSERT_TRUE(std::equal(fields.begin(), fields.begin() + static_cast<std::ptrdiff_t>(n), back.begin()))
                << bits << " bits, " << n;
        }
    }
}

TEST(PackedDelta2, BlocksHoldEveryNumberOnce) {
    for (const std::size_t k : {1, 3, 28}) {
        for (const std::size_t records : {0, 1, 127, 128, 129, 400}) {
            Pairs pairs;
            for (std::size_t i = 0; i < records; ++i) pairs.push_back(static_cast<std::uint16_t>(i % 5 == 0 ? i % (k + 1) : k));
            const Delta2Blocks blocks(pairs, k);
            std::size_t numbers = 0, of_last_base = 0;
            for (std::size_t block = 0; block < blocks.count(); ++block) {
                EXPECT_GE(blocks.size(block), 1u);
                EXPECT_LE(blocks.size(block), kFieldsPerBlock);
                numbers += blocks.size(block);
                of_last_base += blocks.base(block) == k ? blocks.size(block) : 0;
            }
            EXPECT_EQ(numbers, std::accumulate(pairs.begin(), pairs.end(), std::size_t{0}));
            EXPECT_EQ(of_last_base, blocks.rest());
        }
    }
}

// Any bits at all: signs, zeros, subnormals, infinities and jumps from one to the next.
TEST(PackedDelta2, AnyMultiplesOfAStepComeBackToTheBit) {
    std::mt19937 random(2);
    for (unsigned step = 1; step <= 22; ++step) {
        for (const std::size_t k : {1, 2, 4, 7, 28}) {
            for (const std::size_t records : {1, 3, 128, 131, 300}) {
                Pairs pairs;
                std::vector<float> values;
                for (std::size_t i = 0; i < records; ++i) {
                    pairs.push_back(static_cast<std::uint16_t>(random() % 4 == 0 ? random() % (k + 1) : k));
                    const bool wild = random() % 8 == 0;
                    for (std::size_t p = 0; p < pairs.back(); ++p) {
                        const std::uint32_t bits = wild ? random() : 0x3F000000u + random() % 0x00FFFFFFu;
                        values.push_back(std::bit_cast<float>(bits >> step << step));
                    }
                }
                ASSERT_EQ(packed_and_back(values, pairs, k, step), bits_of(values)) << step << ' ' << k << ' ' << records;
            }
        }
    }
}

TEST(PackedDelta2, AFewWildNumbersWidenNoField) {
    const std::size_t k = 4, records = 128;
    const Pairs pairs(records, k);
    std::vector<float> values(k * records);
    for (std::uint32_t i = 0; i < values.size(); ++i) values[i] = std::bit_cast<float>(0x3F000000u + (i * 7 % 4 << 14));
    Delta2Packer packer;
    packer.pack(values, pairs, k, 14);
    const Bytes widths = packer.planes()[kWidths];
    EXPECT_TRUE(packer.planes()[kPositions].empty());
    values[5 * k] = std::bit_cast<float>(0x3FC00000u);
    packer.pack(values, pairs, k, 14);
    EXPECT_EQ(packer.planes()[kWidths], widths);
    EXPECT_EQ(packer.planes()[kPositions][0], std::byte{5});
    EXPECT_EQ(packed_and_back(values, pairs, k, 14), bits_of(values));
}

TEST(PackedDelta2, WhatCannotBeIsRefused) {
    const Pairs pairs(40, 2);
    const std::vector<float> values(80, 1.0f);
    Delta2Packer packer;
    packer.pack(values, pairs, 2, 14);
    const Delta2Blocks blocks(pairs, 2);
    const auto sizes = [&](const std::array<Bytes, kDelta2Planes>& planes) {
        return Delta2Unpacker::sizes(blocks, planes[kWidths], planes[kCounts]);
    };
    std::array<Bytes, kDelta2Planes> planes = packer.planes();
    EXPECT_TRUE(sizes(planes));
    planes[kWidths][1] = std::byte{25};
    EXPECT_EQ(sizes(planes).error().code, ErrorCode::kCorrupt);
    planes = packer.planes();
    planes[kCounts][0] = std::byte{41};
    EXPECT_EQ(sizes(planes).error().code, ErrorCode::kCorrupt);
    planes[kCounts][0] = std::byte{1};
    for (const std::size_t plane : {kPositions, kExtraLow, kExtraHigh}) planes[plane] = {std::byte{39}};
    std::vector<float> back(80);
    EXPECT_TRUE(Delta2Unpacker().unpack(blocks, spans_of(planes), pairs, 14, back));
    planes[kPositions][0] = std::byte{40};
    EXPECT_EQ(Delta2Unpacker().unpack(blocks, spans_of(planes), pairs, 14, back).error().code, ErrorCode::kCorrupt);
}

// The transform of column power in a page of the first so many samples.
Transform transform_of_power(std::uint64_t samples, std::uint8_t precision) {
    Job job = synthetic::make_job(RecordKind::kSpectral);
    job.precision = precision;
    const Result<Bytes> run = encode_run(job, Coverage({0, samples}), synthetic::make_records(job, {0, samples}));
    const RunHeader header = *decode_run_header(*run);
    const RunIndex index = *decode_run_index(ByteSpan(*run).subspan(header.index_offset()), header, job);
    const PageInfo& page = index.pages[0];
    std::vector<ColumnEntry> table;
    EXPECT_TRUE(read_table(job, page, ByteSpan(*run).subspan(page.offset, page.stored_size), table));
    return std::ranges::find(table, Column::kPower, &ColumnEntry::column)->transform;
}

TEST(PackedDelta2, IsForRoundedValuesOfManyRecords) {
    EXPECT_EQ(transform_of_power(3000, 9), Transform::kPackedDelta2);
    EXPECT_EQ(transform_of_power(3000, 15), Transform::kPackedDelta2);
    EXPECT_EQ(transform_of_power(3000, 23), Transform::kDelta2);
    EXPECT_EQ(transform_of_power(3, 9), Transform::kSteppedDelta2);
}

}  // namespace
}  // namespace latent::sampledb
