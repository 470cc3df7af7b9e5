// What a reader of today does when it meets something later: docs/format.md, "Versions and extensions".
#include <gtest/gtest.h>

#include <algorithm>

#include "base/hash.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/codec/page_encoder.h"
#include "sampledb/codec/run_codec.h"
#include "sampledb/format/file_header.h"
#include "sampledb/format/footer.h"
#include "sampledb/format/frames.h"
#include "sampledb/format/run_index.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

constexpr std::size_t kFront = 64;  // of a header: what is checked before its size is believed

// A header with its hashes made right.
Bytes sealed(Bytes header) {
    store_le(&header[32], hash64(ByteSpan(header).subspan(kFront)));
    store_le(&header[56], hash64(ByteSpan(header).first(56)));
    return header;
}

Bytes one_copy(const Job& job) {
    Bytes both = *encode_file_header({job, R"({"host": "a"})"});
    both.resize(both.size() / 2);
    return both;
}

TEST(Extensions, FieldsOfALaterMinorVersionAreReadPast) {
    Job job = synthetic::make_job(RecordKind::kSpectral);
    job.precision = 11;
    job.positions = synthetic::pixels_of(3, 2);
    Bytes header = one_copy(job);
    const std::uint64_t body_size = load_le<std::uint64_t>(&header[24]);
    store_le(&header[10], std::uint16_t{3});
    store_le(&header[24], body_size + 5);
    std::fill_n(header.begin() + static_cast<std::ptrdiff_t>(kFront + body_size), 5, std::byte{7});
    const Result<FileHeader> read = decode_file_header(sealed(header));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_TRUE(same_job(read->job, job));
    EXPECT_EQ(read->provenance_json, R"({"host": "a"})");

    for (const std::uint16_t minor : {0, 1, 2}) {  // the fields fill the body
        store_le(&header[10], minor);
        EXPECT_EQ(decode_file_header(sealed(header)).error().code, ErrorCode::kCorrupt);
    }
}

TEST(Extensions, AnyUnknownFeatureOfAHeaderOrRunIsRefused) {
    const Job job = synthetic::make_job(RecordKind::kXyz);
    const Bytes run = *encode_run(job, Coverage(SampleRange{0, 3}), synthetic::make_records(job, {0, 3}));
    for (int bit = 0; bit < 64; ++bit) {
        Bytes header = one_copy(job), other = run;
        store_le(&header[16], std::uint64_t{1} << bit);
        const Result<FileHeader> read = decode_file_header(sealed(header));
        if (bit == 1) {  // known, and set in every header
            EXPECT_TRUE(read);
        } else {  // bits 0, 2 and 3 are known, and contradict a header without a precision, with few columns and by Halton
            EXPECT_EQ(read.error().code, bit == 0 || bit == 2 || bit == 3 ? ErrorCode::kCorrupt : ErrorCode::kUnsupported);
        }
        store_le(&other[16], std::uint64_t{1} << bit);
        store_le(&other[248], hash64(ByteSpan(other).first(248)));
        EXPECT_EQ(decode_run_header(other).error().code, ErrorCode::kUnsupported);
    }
}

TEST(Extensions, ARunOfALaterMinorVersionIsReadAndKeepsThatVersionInFooters) {
    const Job job = synthetic::make_job(RecordKind::kXyz);
    Bytes run = *encode_run(job, Coverage(SampleRange{0, 3}), synthetic::make_records(job, {0, 3}));
    RunHeader expected = *decode_run_header(run);
    store_le(&run[10], std::uint16_t{9});
    store_le(&run[248], hash64(ByteSpan(run).first(248)));
    const Result<RunHeader> read = decode_run_header(run);
    ASSERT_TRUE(read) << read.error().message;
    expected.minor = 9;
    EXPECT_EQ(*read, expected);
    EXPECT_EQ(encode_run_header(*read), Bytes(run.begin(), run.begin() + kRunHeaderSize));
    const Bytes footer = *encode_footer(std::vector{RunInfo{0, *read}}, "", kBlock);
    EXPECT_TRUE(std::equal(&run[8], &run[136], &footer[64]));
}

// A page of one sample, stored; where its table says how column z is transformed; what the index says of it.
struct StoredPage {
    Bytes bytes;
    std::size_t transform_of_z = 0;
    PageInfo info;

    explicit StoredPage(const Job& job) {
        Page page;
        page.count = 2;
        page.sample = {4, 9}, page.u = {1, 2}, page.v = {3, 4}, page.share = {1, 1};
        page.x = {1, 2}, page.y = {3, 5}, page.z = {7, 11};
        info = PageEncoder().encode(job, page, bytes);
        std::size_t entry = 4;
        while (bytes[entry] != std::byte{7}) entry += 24 + 4 * std::to_integer<std::size_t>(bytes[entry + 3]);
        transform_of_z = entry + 1;
    }
};

TEST(Extensions, ATransformThatIsNotKnownCostsItsColumnOnly) {
    const Job job = synthetic::make_job(RecordKind::kXyz);
    StoredPage stored(job);
    for (int transform = 11; transform < 256; ++transform) {
        stored.bytes[stored.transform_of_z] = static_cast<std::byte>(transform);
        stored.info.stored_hash = hash64(stored.bytes);
        Page page;
        const Status all = PageDecoder().decode(job, stored.info, stored.bytes, ColumnSet{}, page);
        ASSERT_FALSE(all);
        EXPECT_EQ(all.error().code, ErrorCode::kUnsupported);
        EXPECT_NE(all.error().message.find("transform " + std::to_string(transform)), std::string::npos);
        const Status others = PageDecoder().decode(job, stored.info, stored.bytes, ColumnSet{.values = false}, page);
        ASSERT_TRUE(others) << others.error().message;
        EXPECT_EQ(page.sample[1], 9u);
        EXPECT_EQ(page.v[1], 4u);
    }
}

}  // namespace
}  // namespace latent::sampledb
