// Merge reads what it copies: no damaged byte of a part gets into the output, and what is lost is named.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "tests/faults/process.h"
#include "tests/support/opened_runs.h"
#include "tests/support/synthetic.h"
#include "tools/merge/merge.h"

namespace latent::merge {
namespace {

namespace fs = std::filesystem;
using namespace sampledb;
using namespace latent::testing;

using synthetic::make_short_job;
using synthetic::open_runs;
using synthetic::runs_between;
using synthetic::runs_of;

constexpr std::uint64_t kSamples = synthetic::kShortRun;

class MergeDamage : public ::testing::Test {
 protected:
    TemporaryFolder folder_;
    const Job job_ = make_short_job();
    const std::vector<Coverage> four_ = runs_between({0, kSamples, 2 * kSamples, 3 * kSamples, 4 * kSamples});
    const synthetic::FileBytes sound_ = synthetic::make_file(job_, four_);
    const fs::path out_ = folder_ / "out.latent";

    fs::path write(const std::string& name, ByteSpan bytes) const {
        synthetic::write_file(folder_ / name, bytes);
        return folder_ / name;
    }
    Result<MergeReport> merge_to_out(const std::vector<fs::path>& inputs, bool compact = false,
                                     VerifyLevel level = MergeOptions{}.verify) const {
        MergeOptions options;
        options.inputs = inputs;
        options.output = out_;
        options.replace = options.skip_duplicates = true;
        options.compact = compact;
        options.verify = level;
        return merge(options);
    }
    // The offset of a byte in the middle of run `run`, in its pages but not in the last.
    std::size_t inside(std::size_t run) const { return (run == 0 ? sound_.header_size : sound_.run_ends[run - 1]) + 5000; }
    Bytes flipped(std::vector<std::size_t> places) const {
        Bytes bytes = sound_.bytes;
        for (const std::size_t at : places) bytes[at] ^= std::byte{0x10};
        return bytes;
    }
};

// Whole runs of a file, as they stand there.
std::vector<std::string> run_bytes(const fs::path& file) {
    const std::string bytes = read_text(file);
    const auto run_set = open_runs({file});
    std::vector<std::string> runs;
    for (const SelectedRun& run : run_set->runs()) runs.push_back(bytes.substr(run.offset, run.header.size()));
    return runs;
}

TEST_F(MergeDamage, OfTwoHundredDamagedPartsNonePasses) {
    std::vector<std::size_t> places;
    std::mt19937_64 random(1);
    const std::size_t copy = sound_.header_size / 2;
    for (const std::size_t begin : {std::size_t{0}, copy}) {
        for (const std::size_t at : {std::size_t{3}, std::size_t{45}, std::size_t{100}, copy - 1}) places.push_back(begin + at);
    }
    for (std::size_t run = 0; run < 4; ++run) {
        const std::size_t begin = run == 0 ? sound_.header_size : sound_.run_ends[run - 1], end = sound_.run_ends[run];
        for (const std::size_t at : {0, 9, 60, 130, 200, 250, 256, 262})
            places.push_back(begin + at);                                                             // its header, a page's table
        for (int i = 0; i < 30; ++i) places.push_back(begin + 256 + random() % (end - begin - 256));  // pages, index, padding
        places.push_back(end - 1);
    }
    while (places.size() < 200) places.push_back(sound_.run_ends[3] + random() % (sound_.bytes.size() - sound_.run_ends[3]));
    const fs::path whole = write("whole.latent", sound_.bytes);
    for (const bool compact : {false, true}) {
        ASSERT_TRUE(merge_to_out({whole}, compact));
        const std::string expected = read_text(out_);
        for (const std::size_t at : places) {
            SCOPED_TRACE(at);
            const Result<MergeReport> report = merge_to_out({write("part.latent", flipped({at}))}, compact);
            ASSERT_TRUE(report) << report.error().message;
            const auto out = open_runs({out_});  // decodes and checks every record
            ASSERT_TRUE(out);
            const std::vector<LeftOut>& left_out = report->run_set.left_out;
            if (at < sound_.header_size) {  // the other copy of the header serves
                EXPECT_TRUE(left_out.empty());
                EXPECT_EQ(report->run_set.notes.size(), 1u);
                EXPECT_EQ(read_text(out_), expected);
                continue;
            }
            ASSERT_FALSE(left_out.empty());
            EXPECT_EQ(left_out.front().place, (folder_ / "part.latent").string());
            Coverage kept(SampleRange{0, 4 * kSamples});
            for (std::size_t run = 0; run < 4; ++run) {
                if (at >= inside(run) - 5000 && at < sound_.run_ends[run]) kept.remove(four_[run]);
            }
            EXPECT_EQ(out->coverage(), kept);
        }
    }
}

TEST_F(MergeDamage, QuickLooksAtOnePageStoredAtEveryByteAndFullAtEveryRecord) {
    const fs::path part = write("part.latent", flipped({inside(1)}));
    for (const auto& [level, found] :
         {std::pair(VerifyLevel::kQuick, false), std::pair(VerifyLevel::kStored, true), std::pair(VerifyLevel::kFull, true)}) {
        const Result<MergeReport> report = merge_to_out({part}, false, level);
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_EQ(!report->run_set.left_out.empty(), found);
        EXPECT_EQ(report->runs_out, found ? 3u : 4u);
    }
}

TEST_F(MergeDamage, TheSameSamplesElsewhereStandInForADamagedRun) {
    fs::create_directory(folder_ / "parts");
    write("parts/a.latent", flipped({inside(0), inside(2)}));
    write("parts/b.latent", synthetic::make_file(job_, {{four_[1], four_[2]}}).bytes);  // run 1 is there twice
    const std::vector<Coverage> checkpoints = {Coverage(SampleRange{0, 1024}), Coverage(SampleRange{2048, 3072})};
    write("parts/c.latent", synthetic::make_file(job_, checkpoints).bytes);
    const Result<MergeReport> report = merge_to_out({folder_ / "parts"});
    ASSERT_TRUE(report) << report.error().message;
    Coverage expected(SampleRange{kSamples, 4 * kSamples});
    for (const Coverage& checkpoint : checkpoints) expected.add(checkpoint);
    EXPECT_EQ(open_runs({out_})->coverage(), expected);
    EXPECT_EQ(report->run_set.left_out.size(), 2u);
    EXPECT_EQ(report->coverage, expected);
    const std::vector<std::string> runs = run_bytes(out_);
    fs::remove(folder_ / "parts/a.latent");
    write("parts/d.latent", synthetic::make_file(job_, {{four_[3]}}).bytes);
    ASSERT_TRUE(merge_to_out({folder_ / "parts"}));
    EXPECT_EQ(run_bytes(out_), runs);  // as if the damaged ones had never been there
}

TEST_F(MergeDamage, TheOutputIsWhatIsLeftAndNotAByteMore) {
    for (const std::vector<std::size_t>& broken : std::vector<std::vector<std::size_t>>{{0}, {1}, {3}, {0, 1}, {1, 3}, {0, 1, 2}}) {
        std::vector<std::size_t> places;
        std::vector<Coverage> left;
        for (std::size_t run = 0; run < 4; ++run) {
            if (std::ranges::count(broken, run) > 0) {
                places.push_back(inside(run));
            } else {
                left.push_back(four_[run]);
            }
        }
        const fs::path part = write("part.latent", flipped(places));
        for (const bool compact : {false, true}) {
            ASSERT_TRUE(merge_to_out({part}, compact));
            const std::string out = read_text(out_);
            write("part.latent", synthetic::make_file(job_, left).bytes);
            ASSERT_TRUE(merge_to_out({part}, compact));
            EXPECT_EQ(out, read_text(out_));
            write("part.latent", flipped(places));
        }
    }
}

TEST_F(MergeDamage, ItDoesNotMatterHowMuchIsCopiedAtOnce) {
    for (const Bytes& bytes : {sound_.bytes, flipped({inside(1)})}) {
        const fs::path part = write("part.latent", bytes);
        ASSERT_TRUE(merge_to_out({part}));
        const std::string expected = read_text(out_);
        for (const std::uint64_t piece : {4096, 20480, 1 << 17}) {
            MergeOptions options;
            options.inputs = {part};
            options.output = out_;
            options.replace = true;
            options.piece = piece;
            ASSERT_TRUE(merge(options));
            EXPECT_EQ(read_text(out_), expected) << piece;
        }
    }
}

TEST_F(MergeDamage, RequiredSamplesThatWereDamagedAreMissing) {
    const fs::path part = write("part.latent", flipped({inside(2)}));
    MergeOptions options;
    options.inputs = {part};
    options.output = out_;
    options.require = SampleRange{0, 4 * kSamples};
    const Result<MergeReport> report = merge(options);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::kMismatch);
    EXPECT_NE(report.error().message.find("8192:12288"), std::string::npos) << report.error().message;
    EXPECT_FALSE(fs::exists(out_));
}

TEST_F(MergeDamage, TheToolNamesWhatItLeftOutAndEndsWithThree) {
    const fs::path part = write("part.latent", flipped({inside(2)}));
    for (const std::vector<std::string>& options : {std::vector<std::string>{}, {"--compact"}, {"--verify", "full"}}) {
        std::vector<std::string> words = {tool("latent-merge"), part, "-o", out_, "--force"};
        words.insert(words.end(), options.begin(), options.end());
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 3) << outcome.err;
        EXPECT_EQ(outcome.err, "latent-merge: warning: " + part.string() + ": left out: run at byte " +
                                   std::to_string(sound_.run_ends[1]) + ": page 0: checksum mismatch; samples 8192:12288 lost\n");
    }
}

TEST_F(MergeDamage, FilesThatCanShareBlocksShareThem) {
    const SharingDisk disk;
    if (!disk.mounted()) GTEST_SKIP() << "no file system with shared blocks can be made here (mkfs.xfs, a loop device, root)";
    Job job = job_;
    job.run_samples = 1u << 17;
    std::uint64_t bytes = 0;
    std::vector<std::string> command = {tool("latent-merge"), "-o", disk / "out.latent"};
    for (std::uint64_t i = 0; i < 4; ++i) {
        const fs::path part = disk / (std::to_string(i) + ".latent");
        synthetic::write_file(part, synthetic::make_file(job, std::vector{Coverage(SampleRange{i << 17, (i + 1) << 17})}).bytes);
        bytes += fs::file_size(part);
        command.push_back(part);
    }
    const std::uint64_t before = disk.used();
    ASSERT_EQ(run(command).status, 0);
    EXPECT_LT(disk.used() - before, bytes / 50);
    EXPECT_EQ(open_runs({disk / "out.latent"})->coverage(), Coverage(SampleRange{0, std::uint64_t{4} << 17}));
}

}  // namespace
}  // namespace latent::merge
