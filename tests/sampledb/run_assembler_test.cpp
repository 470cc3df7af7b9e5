#include "sampledb/write/run_assembler.h"

#include <gtest/gtest.h>

#include <random>

#include "sampledb/codec/run_codec.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

Job job_with(std::uint32_t run_samples, std::uint64_t run_bytes) {
    Job job = synthetic::make_job(RecordKind::kXyz);
    job.run_samples = run_samples;
    job.run_bytes = run_bytes;
    return job;
}

GrainPtr grain_of(SampleRange range, std::size_t records) {
    Grain grain{range, {}};
    grain.records.sample.assign(records, range.first);  // 8 raw bytes a record
    return std::make_shared<const Grain>(std::move(grain));
}

// Ends of the runs that grains with these raw bytes make; grain i is skipped over if `stored` says that a run begins there.
std::vector<std::uint64_t> run_ends(const Job& job, SampleRange range, const std::vector<std::size_t>& records) {
    RunAssembler assembler(job, range);
    std::vector<std::uint64_t> ends;
    for (std::size_t i = 0; !assembler.done(); ++i) {
        for (const AssembledRun& run : assembler.add(grain_of(grain_range(assembler.next(), range), records[i % records.size()]))) {
            EXPECT_EQ(run.samples.first, ends.empty() ? range.first : ends.back());
            EXPECT_EQ(run.grains.front()->range.first, run.samples.first);
            EXPECT_EQ(run.grains.back()->range.end, run.samples.end);
            ends.push_back(run.samples.end);
        }
    }
    EXPECT_TRUE(assembler.open_grains().empty());
    return ends;
}

TEST(RunAssembler, RunsEndAtMultiplesOfSAndAtTheEndOfTheRange) {
    const Job job = job_with(4096, 1 << 30);
    EXPECT_EQ(run_ends(job, {4096, 4096 * 3 + 1500}, {1024}), (std::vector<std::uint64_t>{8192, 12288, 13788}));
    EXPECT_EQ(run_ends(job, {0, 100}, {7}), (std::vector<std::uint64_t>{100}));
    EXPECT_EQ(run_ends(job, {0, 8192}, {0}), (std::vector<std::uint64_t>{4096, 8192}));  // samples without records count too
}

TEST(RunAssembler, ARunEndsBeforeTheGrainThatWouldTakeItOverR) {
    const Job job = job_with(8192, 24000);  // three grains of 1000 records fill it to the byte
    EXPECT_EQ(run_ends(job, {0, 8192}, {1000}), (std::vector<std::uint64_t>{3072, 6144, 8192}));
    EXPECT_EQ(run_ends(job, {0, 8192}, {1000, 1000, 1001}), (std::vector<std::uint64_t>{2048, 4096, 6144, 8192}));
}

TEST(RunAssembler, AGrainLargerThanRIsARunAlone) {
    const Job job = job_with(8192, 24000);
    EXPECT_EQ(run_ends(job, {0, 4096}, {100, 5000, 5000, 100}), (std::vector<std::uint64_t>{1024, 2048, 3072, 4096}));
}

TEST(RunAssembler, BoundariesAreThoseOfTheWholeJobWhateverTheShards) {
    const Job job = job_with(8192, 50000);
    std::mt19937 random(1);
    std::vector<std::size_t> records(64);
    for (std::size_t& n : records) n = random() % 4000;
    const std::vector<std::uint64_t> whole = run_ends(job, {0, 65536}, records);
    for (const std::uint64_t cut : {8192u, 24576u, 57344u}) {
        std::vector<std::uint64_t> ends = run_ends(job, {0, cut}, records);
        std::vector<std::size_t> rest(records.begin() + static_cast<std::ptrdiff_t>(cut / kGrainSamples), records.end());
        for (const std::uint64_t end : run_ends(job, {cut, 65536}, rest)) ends.push_back(end);
        EXPECT_EQ(ends, whole);
    }
}

TEST(RunAssembler, SkippingAStoredRunEndsTheRunBeforeIt) {
    const Job job = job_with(8192, 24000);
    RunAssembler assembler(job, {0, 8192});
    EXPECT_TRUE(assembler.add(grain_of({0, 1024}, 1000)).empty());
    const std::vector<AssembledRun> closed = assembler.skip({1024, 8192});
    ASSERT_EQ(closed.size(), 1u);
    EXPECT_EQ(closed[0].samples, (SampleRange{0, 1024}));
    EXPECT_TRUE(assembler.done());
}

TEST(RunAssembler, SplittingARunGivesItsGrainsBack) {
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        Job job = synthetic::make_job(kind);
        job.extra = {{"depth", ColumnType::kF32}};
        const SampleRange range{4096, 4096 + 3 * 1024 + 77};
        std::vector<GrainPtr> grains;
        for (std::uint64_t first = range.first; first < range.end; first = grains.back()->range.end) {
            const SampleRange grain = grain_range(first, range);
            grains.push_back(std::make_shared<const Grain>(Grain{grain, synthetic::make_records(job, grain)}));
        }
        const std::vector<GrainPtr> again = split(synthetic::make_records(job, range), Coverage(range), range);
        ASSERT_EQ(again.size(), grains.size());
        for (std::size_t i = 0; i < grains.size(); ++i) {
            EXPECT_EQ(again[i]->range, grains[i]->range);
            EXPECT_EQ(again[i]->records.sample, grains[i]->records.sample);
            EXPECT_EQ(again[i]->records.x, grains[i]->records.x);
            EXPECT_EQ(again[i]->records.power, grains[i]->records.power);
            EXPECT_EQ(again[i]->records.pairs, grains[i]->records.pairs);
            EXPECT_EQ(again[i]->records.extra[0].values, grains[i]->records.extra[0].values);
            EXPECT_EQ(again[i]->records.raw_bytes(), grains[i]->records.raw_bytes());
        }
    }
}

TEST(RunAssembler, AGrainWithoutRecordsHasTheColumnsOfItsJob) {
    Job job = synthetic::make_job(RecordKind::kXyz);
    job.extra = {{"depth", ColumnType::kF32}};
    const SampleRange range{0, 3 * 1024};
    Records records = synthetic::make_records(job, {0, 1024});
    const Records last = synthetic::make_records(job, {2048, 3072});
    for (std::size_t row = 0; row < last.size(); ++row) records.append(last, row, 0);
    const std::vector<GrainPtr> grains = split(records, Coverage(range), range);
    ASSERT_EQ(grains.size(), 3u);
    EXPECT_TRUE(grains[1]->records.empty());
    for (const GrainPtr& grain : grains) EXPECT_TRUE(encode_run(job, Coverage(grain->range), grain->records));
}

TEST(RunAssembler, SplittingKeepsWholeGrainsOnly) {
    const Job job = synthetic::make_job(RecordKind::kSpectral);
    const Records records = synthetic::make_records(job, {0, 5000});
    Coverage coverage(SampleRange{0, 1500});
    coverage.add({2048, 5000});
    const std::vector<GrainPtr> grains = split(records, coverage, {1024, 4500});
    ASSERT_EQ(grains.size(), 3u);  // 1024..1500 is cut short; 4096..4500 is the whole last grain of the range
    EXPECT_EQ(grains[0]->range, (SampleRange{2048, 3072}));
    EXPECT_EQ(grains[2]->range, (SampleRange{4096, 4500}));
    const Records alone = synthetic::make_records(job, {2048, 3072});
    EXPECT_EQ(grains[0]->records.sample, alone.sample);
    EXPECT_EQ(grains[0]->records.power, alone.power);
}

}  // namespace
}  // namespace latent::sampledb
