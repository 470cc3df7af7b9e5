#include "tools/merge/compact.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/file.h"
#include "base/parallel.h"
#include "tests/faults/process.h"
#include "tests/support/opened_runs.h"
#include "tests/support/synthetic.h"
#include "tools/merge/merge.h"

namespace latent::merge {
namespace {

namespace fs = std::filesystem;
using namespace sampledb;
using latent::testing::TemporaryFolder;

using synthetic::make_short_job;
using synthetic::open_runs;

constexpr std::uint64_t kRun = synthetic::kShortRun;

class CompactTest : public ::testing::Test {
 protected:
    TemporaryFolder folder_;

    fs::path write(const std::string& name, const Job& job, const std::vector<Coverage>& runs) {
        synthetic::Scene scene;
        scene.split_shares = true;
        scene.light_per_sample = 0.3;
        synthetic::write_file(folder_ / name, synthetic::make_file(job, runs, true, scene).bytes);
        return folder_ / name;
    }
    MergeReport compact(const std::vector<fs::path>& inputs, const std::string& output,
                        std::uint64_t memory = std::uint64_t{1} << 30) {
        MergeOptions options;
        options.inputs = inputs;
        options.output = folder_ / output;
        options.compact = true;
        options.memory = memory;
        const Result<MergeReport> report = merge(options);
        EXPECT_TRUE(report) << report.error().message;
        return report ? *report : MergeReport{};
    }
};

std::vector<Coverage> intervals(std::uint64_t count) {
    std::vector<Coverage> runs;
    for (std::uint64_t i = 0; i < count; ++i) runs.emplace_back(SampleRange{i * kRun, (i + 1) * kRun});
    return runs;
}

TEST_F(CompactTest, TheNewRunIsTheOneThatAllRecordsTogetherWouldHaveMade) {
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        for (const bool named_columns : {false, true}) {
            Job job = make_short_job(kind);
            if (named_columns) {  // as foreign writers have it
                job.extra = {{"depth", ColumnType::kF32}, {"light_group", ColumnType::kU16}};
                job.positions = {};
                job.density = {};
            }
            const fs::path small = write("small.latent", job, intervals(9));
            const MergeReport report = compact({small}, "large.latent");
            EXPECT_EQ(report.runs_out, 1u);
            const fs::path whole = write("whole.latent", job, {Coverage(SampleRange{0, 9 * kRun})});
            const auto large = open_runs({folder_ / "large.latent"}), expected = open_runs({whole});
            ASSERT_TRUE(large && expected);
            RunHeader header = large->runs()[0].header;
            EXPECT_EQ(header, expected->runs()[0].header);
            for (const char* name : {"small.latent", "large.latent", "whole.latent"}) fs::remove(folder_ / name);
        }
    }
}

TEST_F(CompactTest, OnlyWholeIntervalsAreRewritten) {
    const Job job = make_short_job(RecordKind::kXyz);
    // 0..S whole; S..2S in two runs that were cut at R; 2S..3S a checkpoint; 3S..4S and 5S..6S whole; 6S..6S+100 the end of the
    // range.
    const fs::path file = write(
        "a.latent", job,
        {Coverage(SampleRange{0, kRun}), Coverage(SampleRange{kRun, kRun + 3072}), Coverage(SampleRange{kRun + 3072, 2 * kRun}),
         Coverage(SampleRange{2 * kRun, 2 * kRun + 1024}), Coverage(SampleRange{3 * kRun, 4 * kRun}),
         Coverage(SampleRange{5 * kRun, 6 * kRun}), Coverage(SampleRange{6 * kRun, 6 * kRun + 100})});
    compact({file}, "out.latent");
    const auto out = open_runs({folder_ / "out.latent"}), in = open_runs({file});
    ASSERT_EQ(out->runs().size(), 4u);
    EXPECT_EQ(out->runs()[0].coverage, Coverage::of({{0, 2 * kRun}}));
    EXPECT_EQ(out->runs()[1].coverage, Coverage::of({{2 * kRun, 2 * kRun + 1024}}));
    EXPECT_EQ(out->runs()[1].header, in->runs()[3].header);  // as it was
    EXPECT_EQ(out->runs()[2].coverage, Coverage::of({{3 * kRun, 4 * kRun}, {5 * kRun, 6 * kRun}}));
    EXPECT_EQ(out->runs()[3].header, in->runs()[6].header);
    EXPECT_EQ(out->coverage(), in->coverage());
}

TEST_F(CompactTest, ACompactedRunSupersedesWhatItWasMadeOfAndCanBeCompactedAgain) {
    const Job job = make_short_job(RecordKind::kSpectral);
    const fs::path first = write("first.latent", job, intervals(3));
    compact({first}, "large.latent");
    const auto both = open_runs({folder_.path()});  // a folder with both files: nothing is counted twice
    EXPECT_EQ(both->coverage(), Coverage(SampleRange{0, 3 * kRun}));
    EXPECT_EQ(both->runs().size(), 1u);
    const fs::path rest =
        write("rest.latent", job, {Coverage(SampleRange{3 * kRun, 4 * kRun}), Coverage(SampleRange{4 * kRun, 5 * kRun})});
    compact({folder_ / "large.latent", rest}, "all.latent");
    const fs::path whole = write("whole.latent", job, {Coverage(SampleRange{0, 5 * kRun})});
    EXPECT_EQ(open_runs({folder_ / "all.latent"})->runs()[0].header.content_hash,
              open_runs({whole})->runs()[0].header.content_hash);
}

TEST_F(CompactTest, LessMemoryMakesMoreAndSmallerRunsOfTheSameRecords) {
    const Job job = make_short_job(RecordKind::kXyz);
    const fs::path file = write("a.latent", job, intervals(16));
    compact({file}, "small.latent", std::uint64_t{4} << 20);
    const auto small = open_runs({folder_ / "small.latent"});
    EXPECT_GT(small->runs().size(), 1u);
    EXPECT_LT(small->runs().size(), 16u);
    compact({folder_ / "small.latent"}, "again.latent");
    compact({file}, "large.latent");
    EXPECT_EQ(open_runs({folder_ / "again.latent"})->runs()[0].header, open_runs({folder_ / "large.latent"})->runs()[0].header);
}

// The run that all runs of a file make, as it is stored.
Bytes compacted(const fs::path& input, int threads, std::uint64_t memory) {
    const auto run_set = open_runs({input}, VerifyLevel::kHeaders);
    Result<File> out = File::create_unnamed(input.parent_path());
    EXPECT_TRUE(out) << out.error().message;
    Result<RunHeader> header = RunHeader{};
    Threads(threads).run([&] {
        header = compact_runs(*run_set, {0, run_set->runs().size()}, memory, *out, 0, [](std::uint64_t) {});
    });
    EXPECT_TRUE(header) << header.error().message;
    Bytes run(header->size());
    EXPECT_TRUE(out->read_exact(0, run));
    return run;
}

TEST_F(CompactTest, NeitherThreadsNorMemoryChangeAByteOfANewRun) {
    struct Runs {
        RecordKind kind;
        std::uint64_t samples;  // of a run, which is several pages
    };
    for (const Runs& runs : {Runs{RecordKind::kXyz, 24 * kRun}, Runs{RecordKind::kSpectral, 10 * kRun}}) {
        std::vector<Coverage> ranges;
        for (std::uint64_t i = 0; i < 3; ++i) ranges.emplace_back(SampleRange{i * runs.samples, (i + 1) * runs.samples});
        const fs::path small = write("small.latent", make_short_job(runs.kind), ranges);
        const Bytes run = compacted(small, 1, std::uint64_t{1} << 30);
        EXPECT_EQ(compacted(small, 3, 0), run);  // a page of each run at a time
        const fs::path whole = write("whole.latent", make_short_job(runs.kind), {Coverage(SampleRange{0, 3 * runs.samples})});
        EXPECT_EQ(compacted(whole, 2, 0), run);
    }
}

}  // namespace
}  // namespace latent::merge
