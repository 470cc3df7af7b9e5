// Files that were cut, overwritten or hit by a stray bit: exactly the undamaged runs come back.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "sampledb/read/file_reader.h"
#include "tests/faults/process.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

using synthetic::FileBytes;
using synthetic::make_job;

struct Case {
    const char* name;
    Job job;
    FileBytes file;
};

// Files of at least 64 KB: many runs, so that damage to one leaves others to find.
std::vector<Case> cases() {
    std::vector<Case> all;
    const auto add = [&](const char* name, const Job& job, std::uint64_t samples_per_run, bool footer) {
        std::vector<Coverage> runs;
        for (std::uint64_t i = 0; i < 6; ++i)
            runs.emplace_back(SampleRange{i * job.run_samples, i * job.run_samples + samples_per_run});
        all.push_back({name, job, synthetic::make_file(job, runs, footer, {.light_per_sample = 0.2}, "{\"host\": \"here\"}")});
        EXPECT_GE(all.back().file.bytes.size(), std::size_t{64} << 10) << name;
        EXPECT_LE(all.back().file.bytes.size(), std::size_t{160} << 10) << name;
    };
    Job spectral = make_job(RecordKind::kSpectral);
    Job foreign = spectral;
    foreign.density = {};
    foreign.positions = {};
    add("xyz", make_job(RecordKind::kXyz), 900, true);
    add("spectral", spectral, 120, true);
    add("explicit wavelengths", foreign, 120, false);
    return all;
}

// The runs of the file whose bytes do not meet [first, end).
std::vector<std::size_t> runs_outside(const FileBytes& file, std::size_t first, std::size_t end) {
    std::vector<std::size_t> whole;
    std::size_t begin = file.header_size;
    for (std::size_t i = 0; i < file.run_ends.size(); begin = file.run_ends[i++]) {
        if (file.run_ends[i] <= first || begin >= end) whole.push_back(i);
    }
    return whole;
}

// Reads the bytes, every checksum checked if not told otherwise, and compares with the runs that should be there.
void expect_runs(const Case& c, ByteSpan bytes, const std::vector<std::size_t>& expected,
                 VerifyLevel level = VerifyLevel::kStored) {
    const Result<FileContents> file = read_file(MemorySource(bytes), level);
    if (!file) {
        ASSERT_TRUE(expected.empty()) << file.error().message;
        return;
    }
    ASSERT_EQ(file->runs.size(), expected.size());
    ASSERT_TRUE(same_job(file->header.job, c.job));
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const std::size_t run = expected[i];
        ASSERT_EQ(file->runs[i].offset, run == 0 ? c.file.header_size : c.file.run_ends[run - 1]);
        ASSERT_EQ(file->runs[i].header.samples.first, run * c.job.run_samples);
    }
}

TEST(Damage, AFileCutAtAnyByteYieldsEveryRunBeforeTheCut) {
    for (const Case& c : cases()) {
        for (std::size_t cut = 0; cut < c.file.bytes.size(); ++cut) {
            SCOPED_TRACE(::testing::Message() << c.name << " cut at " << cut);
            expect_runs(c, ByteSpan(c.file.bytes).first(cut), runs_outside(c.file, cut, c.file.bytes.size()),
                        VerifyLevel::kHeaders);
            if (HasFatalFailure()) return;
        }
    }
}

TEST(Damage, AZeroedSectorCostsTheRunThatItMeets) {
    for (const Case& c : cases()) {
        for (std::size_t at = 0; at < c.file.bytes.size(); at += 512) {
            SCOPED_TRACE(::testing::Message() << c.name << " zeroed at " << at);
            Bytes bytes = c.file.bytes;
            const std::size_t end = std::min(at + 512, bytes.size());
            std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.begin() + static_cast<std::ptrdiff_t>(end),
                      std::byte{0});
            const bool unchanged = bytes == c.file.bytes;  // padding is zero
            expect_runs(c, bytes, unchanged ? runs_outside(c.file, 0, 0) : runs_outside(c.file, at, end));
            if (HasFatalFailure()) return;
        }
    }
}

TEST(Damage, AFlippedBitCostsTheRunThatItMeets) {
    for (const Case& c : cases()) {
        Bytes bytes = c.file.bytes;
        for (std::size_t at = 0; at < bytes.size(); ++at) {
            SCOPED_TRACE(::testing::Message() << c.name << " flipped at " << at);
            const std::byte bit{static_cast<unsigned char>(1u << at % 8)};
            bytes[at] ^= bit;
            expect_runs(c, bytes, runs_outside(c.file, at, at + 1));
            bytes[at] ^= bit;
            if (HasFatalFailure()) return;
        }
    }
}

// A disk that lost blocks, or a sparse file: what was never stored is not read, and the runs behind it are found.
TEST(Damage, AHoleInAFileCostsNoRunBehindIt) {
    constexpr std::uint64_t kHole = std::uint64_t{1} << 22;
    const latent::testing::TemporaryFolder folder;
    for (const Case& c : cases()) {
        for (const std::uint64_t shift : {kHole, kHole + 4096, kHole + (std::uint64_t{63} << 12)}) {
            const auto path = folder / "sparse.latent";
            const std::size_t first = c.file.run_ends[0], end = c.file.run_ends.back();
            std::ofstream out(path, std::ios::binary);
            out.write(reinterpret_cast<const char*>(c.file.bytes.data()), static_cast<std::streamsize>(first));
            out.seekp(static_cast<std::streamoff>(shift), std::ios::cur);
            out.write(reinterpret_cast<const char*>(c.file.bytes.data()) + first, static_cast<std::streamsize>(end - first));
            out.close();
            const Result<FileSource> source = FileSource::open(path);
            ASSERT_TRUE(source);
            const Result<FileContents> file = read_file(*source, VerifyLevel::kStored);
            ASSERT_TRUE(file) << file.error().message;
            ASSERT_EQ(file->runs.size(), c.file.run_ends.size()) << c.name;
            EXPECT_EQ(file->runs[1].offset, first + shift);
        }
    }
}

TEST(Damage, FooterAndWalkFindTheSame) {
    for (const Case& c : cases()) {
        const MemorySource source(c.file.bytes);
        const Result<FileContents> listed = read_file(source, VerifyLevel::kFull);
        const Result<FileContents> walked = read_file(source, VerifyLevel::kFull, false);
        ASSERT_TRUE(listed && walked);
        EXPECT_EQ(listed->runs, walked->runs);
        EXPECT_EQ(listed->runs.size(), 6u);
        EXPECT_TRUE(listed->damage.empty() && walked->damage.empty());
    }
}

TEST(Damage, AnUnfinishedTailIsNoDamage) {
    const Job job = make_job(RecordKind::kXyz);
    const std::vector<Coverage> runs = {Coverage(SampleRange{0, 500}), Coverage(SampleRange{500, 1000})};
    const FileBytes file = synthetic::make_file(job, runs, false);
    const Result<FileContents> whole = read_file(MemorySource(file.bytes));
    ASSERT_TRUE(whole);
    EXPECT_FALSE(whole->finished);
    EXPECT_EQ(whole->unfinished_tail, 0u);
    const std::size_t cut = file.run_ends[0] + 1000;
    const Result<FileContents> growing = read_file(MemorySource(ByteSpan(file.bytes).first(cut)));
    ASSERT_TRUE(growing);
    EXPECT_EQ(growing->runs.size(), 1u);
    EXPECT_EQ(growing->unfinished_tail, 1000u);
    EXPECT_TRUE(growing->damage.empty());
    EXPECT_EQ(growing->end, file.run_ends[0]);
}

TEST(Damage, ALastRunWhosePagesNeverReachedTheDiskIsATail) {
    // After a power cut a run's header may be there and its pages not: zeros up to the length of the file.
    const Job job = make_job(RecordKind::kXyz);
    const std::vector<Coverage> runs = {Coverage(SampleRange{0, 3000}), Coverage(SampleRange{3000, 6000})};
    FileBytes file = synthetic::make_file(job, runs, false);
    std::fill(file.bytes.begin() + static_cast<std::ptrdiff_t>(file.run_ends[0] + 4096), file.bytes.end() - 4096, std::byte{0});
    const Result<FileContents> contents = read_file(MemorySource(file.bytes));
    ASSERT_TRUE(contents);
    EXPECT_EQ(contents->runs.size(), 1u);
    EXPECT_EQ(contents->unfinished_tail, file.run_ends[1] - file.run_ends[0]);
}

// A source of which one read is refused.
class RefusedOnce final : public ByteSource {
 public:
    RefusedOnce(ByteSpan bytes, int nth) : bytes_(bytes), left_(nth) {}
    std::uint64_t size() const override { return bytes_.size(); }
    Status read(std::uint64_t offset, std::span<std::byte> into) const override {
        if (--left_ == 0) return Error{ErrorCode::kIo, "memory: cannot read"};
        return bytes_.read(offset, into);
    }
    std::string name() const override { return bytes_.name(); }
    bool refused() const { return left_ <= 0; }

 private:
    MemorySource bytes_;
    mutable int left_;
};

// Whichever read it is.
void expect_refusals(ByteSpan bytes, VerifyLevel level, bool use_footer) {
    bool refused = true;
    for (int nth = 1; refused; ++nth) {
        const RefusedOnce source(bytes, nth);
        const Result<FileContents> contents = read_file(source, level, use_footer);
        refused = source.refused();
        ASSERT_EQ(contents.has_value(), !refused) << nth;
        if (refused) {
            EXPECT_EQ(contents.error().code, ErrorCode::kIo) << nth;
        }
    }
}

TEST(Damage, AReadThatIsRefusedIsAnErrorAndNeverDamage) {
    const std::vector<Coverage> runs = {Coverage(SampleRange{0, 300}), Coverage(SampleRange{16384, 16684})};
    for (const bool footer : {true, false}) {
        const FileBytes whole = synthetic::make_file(make_job(RecordKind::kXyz), runs, footer);
        Bytes beheaded = whole.bytes;  // its first header, and the header of its first run
        beheaded[100] ^= std::byte{1};
        beheaded[whole.header_size + 20] ^= std::byte{1};
        for (const VerifyLevel level : {VerifyLevel::kHeaders, VerifyLevel::kQuick, VerifyLevel::kStored, VerifyLevel::kFull}) {
            for (const bool use_footer : {true, false}) {
                expect_refusals(whole.bytes, level, use_footer);
                expect_refusals(beheaded, level, use_footer);
            }
        }
    }
}

TEST(Damage, ARunOfAnotherJobInsideADamagedRunIsNotRaised) {
    // A foreign run that stands, block aligned, in what is left of a run whose header is gone.
    const Job job = make_job(RecordKind::kXyz, 1);
    const Job other = make_job(RecordKind::kXyz, 2);
    const std::vector<Coverage> runs = {Coverage(SampleRange{0, 3000}), Coverage(SampleRange{16384, 17000})};
    FileBytes file = synthetic::make_file(job, runs, false);
    const FileBytes foreign = synthetic::make_file(other, std::vector<Coverage>{Coverage(SampleRange{0, 100})}, false);
    const ByteSpan run = ByteSpan(foreign.bytes).subspan(foreign.header_size);
    ASSERT_LT(run.size() + 4096, file.run_ends[0] - file.header_size);
    std::ranges::copy(run, file.bytes.begin() + static_cast<std::ptrdiff_t>(file.header_size + 4096));
    file.bytes[file.header_size] = std::byte{0};
    const Result<FileContents> contents = read_file(MemorySource(file.bytes), VerifyLevel::kFull);
    ASSERT_TRUE(contents);
    ASSERT_EQ(contents->runs.size(), 1u);
    EXPECT_EQ(contents->runs[0].header.samples.first, 16384u);
    ASSERT_EQ(contents->damage.size(), 1u);
    EXPECT_EQ(contents->damage[0].size, file.run_ends[0] - file.header_size);
}

}  // namespace
}  // namespace latent::sampledb
