// Files that were written once are read for ever, and docs/format.md says enough to read them.
#include <gtest/gtest.h>

#include <map>

#include "sampledb/codec/page_decoder.h"
#include "sampledb/read/file_reader.h"
#include "tests/faults/process.h"
#include "tests/support/paths.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

namespace fs = std::filesystem;

const fs::path kGolden = latent::testing::in_tree("tests/golden");

// Hash over the decoded values of all columns of all pages, as docs/format.md defines it for a column.
Hash128 decoded_hash(const ByteSource& source, const FileContents& file) {
    Hasher128 hasher;
    PageDecoder decoder;
    Page page;
    const auto add = [&](const auto& column, std::size_t rows) {
        if (!column.empty()) hasher.update(std::as_bytes(std::span(column)).first(rows * sizeof(column[0])));
    };
    for (const RunInfo& run : file.runs) {
        const Result<RunIndex> index = read_run_index(source, run, file.header.job);
        EXPECT_TRUE(index);
        for (const PageInfo& info : index->pages) {
            const Status read = read_page(source, info, file.header.job, ColumnSet{}, decoder, page);
            EXPECT_TRUE(read) << read.error().message;
            add(page.sample, page.count), add(page.u, page.count), add(page.v, page.count), add(page.share, page.count);
            if (file.header.job.kind == RecordKind::kXyz) {
                add(page.x, page.count), add(page.y, page.count), add(page.z, page.count);
            } else {
                add(page.pairs, page.count), add(page.xi, page.count), add(page.index, page.count);
                add(page.power, info.pair_count), add(page.lambda_nm, info.pair_count);
            }
            for (const ExtraColumn& column : page.extra) add(column.values, page.count * width(column.type));
        }
    }
    return hasher.digest();
}

TEST(Golden, FilesAreReadAsTheyWereWritten) {
    const std::map<std::string, std::string> files = {
        {"xyz.latent", "13112ff2d8289399dcb26b5c71400011"},
        {"xyz_extra.latent.part.golden", "93c0899602b185fffaa39bc0661c1621"},
        {"sparse.latent", "a7847b189d86f79b827e8412258811aa"},
        {"rounded.latent", "29cdcc8d65ea9a12e2285ac71223ba81"},
        {"packed.latent", "7a63291c848ce960228e846ec54927fb"},
        {"spectral.latent", "78d681be18208cd7f3973773c6d7f6b5"},
        {"explicit.latent", "60d0773f5532369c59a4f7a8b22012cd"},
    };
    for (const auto& [name, hash] : files) {
        SCOPED_TRACE(name);
        const Result<FileSource> source = FileSource::open(kGolden / name);
        ASSERT_TRUE(source) << source.error().message;
        const Result<FileContents> file = read_file(*source, VerifyLevel::kFull);
        ASSERT_TRUE(file) << file.error().message;
        EXPECT_EQ(file->finished, name.ends_with(".latent"));
        EXPECT_EQ(file->runs.size(), 2u);
        EXPECT_TRUE(file->damage.empty());
        EXPECT_EQ(to_hex(decoded_hash(*source, *file)), hash);
    }
}

// The reader in Python follows the text of the specification, not this library.
latent::testing::Outcome read_by_specification(const fs::path& file) {
    return latent::testing::run_python("tests/sampledb/read_latent.py", {file.string()});
}

TEST(Golden, TheSpecificationAloneIsEnoughToReadThem) {
    for (const fs::directory_entry& entry : fs::directory_iterator(kGolden)) {
        if (entry.path().filename().string().find(".latent") == std::string::npos) continue;
        const latent::testing::Outcome read = read_by_specification(entry.path());
        EXPECT_EQ(read.status, 0) << read.err;
        EXPECT_NE(read.out.find("2 runs"), std::string::npos) << read.out;
    }
}

TEST(Golden, WhatIsWrittenTodayFollowsTheSpecification) {
    const latent::testing::TemporaryFolder folder;
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        const Job job = synthetic::make_job(kind);
        const std::uint64_t samples = kind == RecordKind::kXyz ? 9000 : 3000;  // several pages
        const std::vector<Coverage> runs = {Coverage(SampleRange{0, samples}), Coverage(SampleRange{1u << 14, (1u << 14) + 10})};
        synthetic::FileBytes file = synthetic::make_file(job, runs, true, {.light_per_sample = 0.3});
        const fs::path path = folder.path() / "part.latent";
        synthetic::write_file(path, file.bytes);
        const latent::testing::Outcome read = read_by_specification(path);
        EXPECT_EQ(read.status, 0) << read.err;
        synthetic::write_file(path, synthetic::make_file(job, runs, true, {.black = 1, .light_per_sample = 0}).bytes);
        EXPECT_EQ(read_by_specification(path).status, 0);
        file.bytes[file.header_size + 5000] ^= std::byte{1};
        synthetic::write_file(path, file.bytes);
        EXPECT_EQ(read_by_specification(path).status, 1);
    }
}

}  // namespace
}  // namespace latent::sampledb
