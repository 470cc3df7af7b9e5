// Files of another writer: tests/sampledb/write_latent.py, which was written from docs/format.md alone.
#include <gtest/gtest.h>

#include "sampledb/codec/run_codec.h"
#include "sampledb/read/file_reader.h"
#include "tests/faults/process.h"

namespace latent::sampledb {
namespace {

namespace fs = std::filesystem;

// A kind of file that the writer makes, and a seed: columns and planes are then stored in any way that the page allows.
class ForeignFile : public ::testing::TestWithParam<std::pair<std::string, std::string>> {};

// Bits are compared by way of content hashes, which cover order and page cut as well.
TEST_P(ForeignFile, HoldsTheRunsThatThisLibraryMakesOfItsRecordsAndTheReaderInPythonReads) {
    const testing::TemporaryFolder folder;
    const fs::path path = folder / "foreign.latent", records = folder / "records";
    const auto& [kind, seed] = GetParam();
    std::vector<std::string> arguments = {kind, path.string(), "--records", records.string()};
    if (!seed.empty()) arguments.insert(arguments.end(), {"--vary", seed});
    const testing::Outcome written = testing::run_python("tests/sampledb/write_latent.py", arguments);
    ASSERT_EQ(written.status, 0) << written.err;

    const testing::Outcome read = testing::run_python("tests/sampledb/read_latent.py", {"--records", path.string()});
    EXPECT_EQ(read.status, 0) << read.err;
    EXPECT_TRUE(read.out == testing::read_text(records));

    const Result<FileSource> source = FileSource::open(path);
    ASSERT_TRUE(source) << source.error().message;
    const Result<FileContents> file = read_file(*source, VerifyLevel::kFull);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_TRUE(file->finished);
    EXPECT_TRUE(file->damage.empty());
    ASSERT_FALSE(file->runs.empty());
    for (const RunInfo& run : file->runs) {
        Bytes bytes(run.header.size());
        ASSERT_TRUE(source->read(run.offset, bytes));
        const Result<DecodedRun> decoded = decode_run(file->header.job, bytes);
        ASSERT_TRUE(decoded) << decoded.error().message;
        const Result<Bytes> again = encode_run(file->header.job, decoded->coverage, decoded->records);
        ASSERT_TRUE(again) << again.error().message;
        EXPECT_EQ(decode_run_header(*again)->content_hash, run.header.content_hash);
    }
}

// Its rounding and ours make the same values of the same records.
TEST(ForeignWriter, RoundsAsThisLibraryDoes) {
    const testing::TemporaryFolder folder;
    for (const char* kind : {"xyz", "spectral", "explicit"}) {
        SCOPED_TRACE(kind);
        const fs::path exact = folder.path() / "exact.latent", rounded = folder.path() / "rounded.latent";
        ASSERT_EQ(testing::run_python("tests/sampledb/write_latent.py", {kind, exact.string()}).status, 0);
        ASSERT_EQ(testing::run_python("tests/sampledb/write_latent.py", {kind, rounded.string(), "--precision", "9", "--vary", "3"})
                      .status,
                  0);
        const testing::Outcome read = testing::run_python("tests/sampledb/read_latent.py", {rounded.string()});
        EXPECT_EQ(read.status, 0) << read.err;

        const Result<FileSource> from = FileSource::open(exact), to = FileSource::open(rounded);
        ASSERT_TRUE(from && to);
        const Result<FileContents> records = read_file(*from, VerifyLevel::kFull), expected = read_file(*to, VerifyLevel::kFull);
        ASSERT_TRUE(records) << records.error().message;
        ASSERT_TRUE(expected) << expected.error().message;
        EXPECT_EQ(expected->header.job.precision, 9);
        ASSERT_EQ(records->runs.size(), expected->runs.size());
        for (std::size_t i = 0; i < records->runs.size(); ++i) {
            Bytes bytes(records->runs[i].header.size());
            ASSERT_TRUE(from->read(records->runs[i].offset, bytes));
            const Result<DecodedRun> run = decode_run(records->header.job, bytes);
            ASSERT_TRUE(run) << run.error().message;
            const Result<Bytes> ours = encode_run(expected->header.job, run->coverage, run->records);
            ASSERT_TRUE(ours) << ours.error().message;
            EXPECT_EQ(decode_run_header(*ours)->content_hash, expected->runs[i].header.content_hash);
        }
    }
}

std::vector<std::pair<std::string, std::string>> foreign_files() {
    std::vector<std::pair<std::string, std::string>> files = {{"smallest", ""}};
    for (const char* kind : {"xyz", "spectral", "explicit"}) {
        for (const char* seed : {"", "1", "2"}) files.emplace_back(kind, seed);
    }
    return files;
}

INSTANTIATE_TEST_SUITE_P(All, ForeignFile, ::testing::ValuesIn(foreign_files()), [](const auto& file) {
    return file.param.first + (file.param.second.empty() ? "Plain" : "Varied" + file.param.second);
});

}  // namespace
}  // namespace latent::sampledb
