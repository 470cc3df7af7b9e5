#include "sampledb/write/part_writer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <random>
#include <thread>

#include "sampledb/data/limits.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/part_name.h"
#include "sampledb/write/grain_queue.h"
#include "sampledb/write/run_assembler.h"
#include "tests/faults/process.h"
#include "tests/support/opened_runs.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

namespace fs = std::filesystem;
using latent::testing::TemporaryFolder;
using synthetic::make_short_job;
using synthetic::RunContent;
using synthetic::runs_of;

std::vector<SampleRange> grains_of(const Coverage& missing) {
    GrainQueue queue(missing);
    std::vector<SampleRange> grains;
    for (SampleRange grain = queue.next(); !grain.empty(); grain = queue.next()) grains.push_back(grain);
    return grains;
}

Grain make_grain(const Job& job, SampleRange range) { return {range, synthetic::make_records(job, range)}; }

class PartWriterTest : public ::testing::Test {
 protected:
    TemporaryFolder folder_;
    const fs::path name_ = folder_ / "night.latent";

    std::unique_ptr<PartWriter> open(const Job& job, SampleRange range, double checkpoint_seconds = 1000, bool force = false) {
        Result<std::unique_ptr<PartWriter>> writer = PartWriter::open({name_, range, checkpoint_seconds, "{}", force}, job);
        EXPECT_TRUE(writer) << writer.error().message;
        return writer ? std::move(*writer) : nullptr;
    }
    Error refusal(const Job& job, SampleRange range) {
        const Result<std::unique_ptr<PartWriter>> writer = PartWriter::open({name_, range, 1000, "{}", false}, job);
        EXPECT_FALSE(writer);
        return writer ? Error{} : writer.error();
    }
    static void submit_all(PartWriter& writer, const Job& job) {
        for (const SampleRange& grain : grains_of(writer.missing())) ASSERT_TRUE(writer.submit(make_grain(job, grain)));
    }
    // The selected runs of a render that nothing disturbed.
    static std::vector<RunContent> undisturbed(const Job& job, SampleRange range) {
        const TemporaryFolder folder;
        const auto writer = PartWriter::open({folder / "a.latent", range, 1000, "{}", false}, job);
        EXPECT_TRUE(writer) << writer.error().message;
        if (!writer) return {};
        submit_all(**writer, job);
        EXPECT_TRUE((*writer)->finish());
        return runs_of(folder / "a.latent");
    }
};

TEST_F(PartWriterTest, ARangeIsWrittenAsCanonicalRunsAndPublishedUnderItsName) {
    const Job job = make_short_job();
    const SampleRange range{4096, 14000};
    const auto writer = open(job, range);
    EXPECT_EQ(writer->missing(), Coverage(range));
    submit_all(*writer, job);
    ASSERT_TRUE(writer->finish());
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"night.latent"});
    const std::vector<RunContent> runs = runs_of(name_);
    ASSERT_EQ(runs.size(), 3u);
    EXPECT_EQ(runs[0].coverage, Coverage(SampleRange{4096, 8192}));
    EXPECT_EQ(runs[2].coverage, Coverage(SampleRange{12288, 14000}));
    EXPECT_EQ(writer->counts().samples_committed, range.size());
    EXPECT_EQ(writer->counts().runs_written, 3u);
}

TEST_F(PartWriterTest, ThreadsAndTheirOrderDoNotChangeAByte) {
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        const Job job = make_short_job(kind);
        const SampleRange range{0, 40000};
        const auto alone = open(job, range);
        submit_all(*alone, job);
        ASSERT_TRUE(alone->finish());
        const std::string expected = latent::testing::read_text(name_);
        fs::remove(name_);

        const auto writer = open(job, range);
        const std::vector<SampleRange> grains = grains_of(writer->missing());
        std::atomic<std::size_t> next = 0;
        std::vector<std::thread> threads;
        for (int t = 0; t < 4; ++t) {
            threads.emplace_back([&] {
                for (std::size_t i = next++; i < grains.size(); i = next++) ASSERT_TRUE(writer->submit(make_grain(job, grains[i])));
            });
        }
        for (std::thread& thread : threads) thread.join();
        ASSERT_TRUE(writer->finish());
        EXPECT_EQ(latent::testing::read_text(name_), expected);
        fs::remove(name_);
    }
}

TEST_F(PartWriterTest, AnInterruptedRenderEndsAsTheOneThatRanThrough) {
    std::mt19937 random(7);
    for (int trial = 0; trial < 24; ++trial) {
        SCOPED_TRACE(trial);
        Job job = make_short_job(trial % 3 == 0 ? RecordKind::kSpectral : RecordKind::kXyz, static_cast<std::uint64_t>(trial));
        if (trial % 2 == 0) job.run_bytes = kGrainSamples * 64 + random() % 100000;  // runs end at R
        const SampleRange range{0, 8192 + random() % 12000};
        const std::vector<RunContent> expected = undisturbed(job, range);
        for (int life = 0;; ++life) {
            ASSERT_LT(life, 1000);
            const auto writer = open(job, range);
            std::vector<SampleRange> grains = grains_of(writer->missing());
            for (std::size_t i = 0; i + 4 < grains.size(); i += 4)
                std::shuffle(grains.begin() + static_cast<long>(i), grains.begin() + static_cast<long>(i) + 4, random);
            const std::size_t most = random() % 8;
            const bool dies = grains.size() > most;
            if (dies) grains.resize(most);
            for (const SampleRange& grain : grains) {
                ASSERT_TRUE(writer->submit(make_grain(job, grain)));
                if (random() % 4 == 0) {
                    ASSERT_TRUE(writer->checkpoint());
                }
            }
            if (dies) continue;
            ASSERT_TRUE(writer->finish());
            break;
        }
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"night.latent"});
        EXPECT_EQ(runs_of(name_), expected);
        fs::remove(name_);
    }
}

TEST_F(PartWriterTest, ACheckpointHoldsTheFinishedGrainsUpToTheFirstGapThatNoRunHoldsYet) {
    const Job job = make_short_job();
    const SampleRange range{0, 8192};
    auto writer = open(job, range);
    for (const std::uint64_t first : {0u, 1024u, 3072u}) ASSERT_TRUE(writer->submit(make_grain(job, {first, first + 1024})));
    ASSERT_TRUE(writer->checkpoint());
    EXPECT_EQ(writer->counts().samples_committed, 2048u);
    ASSERT_TRUE(writer->checkpoint());  // nothing new: no run
    EXPECT_EQ(writer->counts().checkpoints_written, 1u);
    ASSERT_TRUE(writer->submit(make_grain(job, {2048, 3072})));
    ASSERT_TRUE(writer->submit(make_grain(job, {4096, 5120})));
    ASSERT_TRUE(writer->checkpoint());
    EXPECT_EQ(writer->counts().samples_committed, 5120u);
    writer.reset();
    const std::vector<RunContent> runs = runs_of(name_);
    ASSERT_EQ(runs.size(), 2u);  // the canonical run, which supersedes the first checkpoint, and the second checkpoint
    EXPECT_EQ(runs[0].coverage, Coverage(SampleRange{0, 4096}));
    EXPECT_EQ(runs[1].coverage, Coverage(SampleRange{4096, 5120}));
    EXPECT_EQ(open(job, range)->missing(), Coverage(SampleRange{5120, 8192}));
}

TEST_F(PartWriterTest, ARunThatTakesLongerThanTheIntervalIsCheckpointedAgainAndAgain) {
    const Job job = make_short_job();
    const SampleRange range{0, 4096};
    auto writer = open(job, range, 0.001);
    for (std::uint64_t first = 0; first < 3072; first += 1024) {
        ASSERT_TRUE(writer->submit(make_grain(job, {first, first + 1024})));
        while (writer->counts().samples_committed < first + 1024) std::this_thread::yield();
    }
    EXPECT_EQ(writer->counts().checkpoints_written, 3u);
    writer.reset();
    EXPECT_EQ(open(job, range)->missing(), Coverage(SampleRange{3072, 4096}));
}

TEST_F(PartWriterTest, ASecondWriterTakesUpWhatTheFirstCommittedAndBothEndWell) {
    const Job job = make_short_job();
    const SampleRange range{0, 20000};
    const auto first = open(job, range);
    const std::vector<SampleRange> grains = grains_of(first->missing());
    for (std::size_t i = 0; i < 10; ++i) ASSERT_TRUE(first->submit(make_grain(job, grains[i])));
    ASSERT_TRUE(first->checkpoint());
    const auto second = open(job, range);
    EXPECT_EQ(second->missing(), Coverage(SampleRange{10240, 20000}));
    submit_all(*second, job);
    ASSERT_TRUE(second->finish());
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"night.latent"});
    EXPECT_EQ(runs_of(name_), undisturbed(job, range));

    for (std::size_t i = 10; i < grains.size(); ++i) ASSERT_TRUE(first->submit(make_grain(job, grains[i])));
    ASSERT_TRUE(first->checkpoint());
    EXPECT_TRUE(first->published_elsewhere());  // it noticed at its next run: no need to render on
    EXPECT_EQ(first->counts().samples_committed, range.size());
    ASSERT_TRUE(first->finish());
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"night.latent"});
}

TEST_F(PartWriterTest, TwoWritersAtOnceLeaveOneFile) {
    const Job job = make_short_job();
    const SampleRange range{0, 50000};
    const std::vector<RunContent> expected = undisturbed(job, range);
    for (int trial = 0; trial < 10; ++trial) {
        std::vector<std::thread> writers;
        for (int w = 0; w < 2; ++w) {
            writers.emplace_back([&] {
                const auto writer = open(job, range, 0.002);
                submit_all(*writer, job);
                const Status done = writer->finish();
                EXPECT_TRUE(done) << done.error().message;
            });
        }
        for (std::thread& writer : writers) writer.join();
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"night.latent"});
        EXPECT_EQ(runs_of(name_), expected);
        fs::remove(name_);
    }
}

TEST_F(PartWriterTest, AnAttemptThatVanishesIsWrittenAgain) {
    const Job job = make_short_job();
    const SampleRange range{0, 12288};
    const auto writer = open(job, range);
    for (const SampleRange& grain : grains_of(writer->missing())) {
        ASSERT_TRUE(writer->submit(make_grain(job, grain)));
        ASSERT_TRUE(writer->checkpoint());
        if (grain.first == 5120) fs::remove(attempts_of(name_).at(0));
        if (grain.first == 6144) {
            EXPECT_EQ(attempts_of(name_).size(), 1u);
        }
    }
    fs::remove(attempts_of(name_).at(0));
    ASSERT_TRUE(writer->finish());
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"night.latent"});
    EXPECT_EQ(runs_of(name_), undisturbed(job, range));
}

TEST_F(PartWriterTest, RunsOfAnAttemptThatIsGoneAreReportedAndRenderedAgain) {
    const Job job = make_short_job();
    const SampleRange range{0, 12288};
    auto first = open(job, range);
    const std::vector<SampleRange> grains = grains_of(first->missing());
    for (std::size_t i = 0; i < 4; ++i) ASSERT_TRUE(first->submit(make_grain(job, grains[i])));
    ASSERT_TRUE(first->checkpoint());
    first.reset();
    const fs::path gone = attempts_of(name_).at(0);
    auto second = open(job, range);
    EXPECT_EQ(second->missing(), Coverage(SampleRange{4096, 12288}));
    fs::remove(gone);
    submit_all(*second, job);
    const Status refused = second->finish();
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find(gone.string()), std::string::npos) << refused.error().message;
    second.reset();
    const auto third = open(job, range);
    EXPECT_EQ(third->missing(), Coverage(SampleRange{0, 4096}));
    submit_all(*third, job);
    ASSERT_TRUE(third->finish());
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"night.latent"});
    EXPECT_EQ(runs_of(name_), undisturbed(job, range));
}

TEST_F(PartWriterTest, ANameThatAnotherJobTakesMeanwhileIsLeftToIt) {
    const Job job = make_short_job(), other = make_short_job(RecordKind::kXyz, 2);
    const auto slow = open(job, {0, 4096});
    submit_all(*slow, job);
    const TemporaryFolder elsewhere;
    const auto fast = PartWriter::open({elsewhere / "b.latent", {0, 4096}, 1000, "{}", false}, other);
    submit_all(**fast, other);
    ASSERT_TRUE((*fast)->finish());
    fs::copy(elsewhere / "b.latent", name_);
    const Status refused = slow->finish();
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("night.latent"), std::string::npos) << refused.error().message;
    EXPECT_EQ(runs_of(name_), undisturbed(other, {0, 4096}));
    EXPECT_EQ(attempts_of(name_).size(), 1u);  // nothing is lost
}

TEST_F(PartWriterTest, ANameWithoutRoomForThatOfAnAttemptIsRefused) {
    const Job job = make_short_job();
    const std::size_t most = 255 - (new_attempt("").string().size() + std::string(".latent").size());
    for (const std::size_t length : {most, most + 1}) {
        const PartOptions options{folder_ / (std::string(length, 'a') + ".latent"), {0, 4096}, 1000, "{}", false};
        const auto missing = PartWriter::find_missing(options, job);
        const auto writer = PartWriter::open(options, job);
        EXPECT_EQ(missing.has_value(), length == most);
        EXPECT_EQ(writer.has_value(), length == most);
        if (!writer) {
            EXPECT_EQ(writer.error().code, ErrorCode::kUsage);
            EXPECT_NE(writer.error().message.find("too long"), std::string::npos) << writer.error().message;
        }
    }
}

TEST_F(PartWriterTest, WhatIsPublishedIsNotRenderedAgain) {
    const Job job = make_short_job();
    const SampleRange range{0, 10000};
    auto writer = open(job, range);
    submit_all(*writer, job);
    ASSERT_TRUE(writer->finish());
    const std::string before = latent::testing::read_text(name_);
    writer = open(job, range);
    EXPECT_TRUE(writer->missing().empty());
    EXPECT_EQ(writer->counts().samples_committed, range.size());
    ASSERT_TRUE(writer->finish());
    EXPECT_TRUE(open(job, {4096, 9000})->missing().empty());  // a shorter range is covered as well
    EXPECT_EQ(latent::testing::read_text(name_), before);
}

TEST_F(PartWriterTest, AnotherJobOrRangeUnderTheNameIsRefusedUnlessForced) {
    const Job job = make_short_job(), other = make_short_job(RecordKind::kXyz, 2);
    const std::string provenance = R"({"program":"renderer 1.0","render_epoch":7})";
    auto writer = *PartWriter::open({.path = name_, .range = {0, 4096}, .provenance_json = provenance}, job);
    submit_all(*writer, job);
    const Error unfinished = refusal(other, {0, 4096});
    EXPECT_EQ(unfinished.code, ErrorCode::kMismatch);
    EXPECT_NE(unfinished.message.find("(renderer 1.0, render epoch 7)"), std::string::npos) << unfinished.message;
    ASSERT_TRUE(writer->finish());

    const Error foreign = refusal(other, {0, 4096});
    EXPECT_EQ(foreign.code, ErrorCode::kMismatch);
    EXPECT_NE(foreign.message.find("night.latent"), std::string::npos) << foreign.message;
    EXPECT_NE(foreign.message.find(to_hex(other.id)), std::string::npos) << foreign.message;
    EXPECT_NE(foreign.message.find("--force"), std::string::npos) << foreign.message;
    const Error beyond = refusal(job, {2048, 8192});
    EXPECT_EQ(beyond.code, ErrorCode::kMismatch);
    EXPECT_NE(beyond.message.find("0:4096"), std::string::npos) << beyond.message;
    EXPECT_NE(beyond.message.find("2048:8192"), std::string::npos) << beyond.message;

    writer = open(other, {0, 8192}, 1000, true);
    submit_all(*writer, other);
    ASSERT_TRUE(writer->finish());
    EXPECT_EQ(runs_of(name_), undisturbed(other, {0, 8192}));
}

TEST_F(PartWriterTest, AnUnfinishedShorterRangeIsContinued) {
    const Job job = make_short_job();
    auto writer = open(job, {0, 5500});
    submit_all(*writer, job);
    while (writer->counts().samples_committed < 5500) std::this_thread::yield();  // the closing run too
    writer.reset();
    writer = open(job, {0, 9000});
    EXPECT_EQ(writer->missing(), Coverage(SampleRange{5120, 9000}));  // 5120..5500 is no whole grain
    submit_all(*writer, job);
    ASSERT_TRUE(writer->finish());
    EXPECT_EQ(runs_of(name_), undisturbed(job, {0, 9000}));
}

TEST_F(PartWriterTest, AFinishedPartIsExtendedAndKeepsItsNameUntilTheLongerOneIsThere) {
    const Job job = make_short_job();
    for (const SampleRange before : {SampleRange{0, 5500}, SampleRange{0, 8192}, SampleRange{8192, 9000}, SampleRange{0, 0}}) {
        SCOPED_TRACE(to_string(Coverage(before)));
        auto writer = open(job, before, 1000, true);
        submit_all(*writer, job);
        ASSERT_TRUE(writer->finish());
        const std::string finished = latent::testing::read_text(name_);

        writer = open(job, {0, 13000});
        const Coverage missing = writer->missing();
        EXPECT_LE(missing.size(), 13000 - before.size() + kGrainSamples);  // the last grain of the range may have been cut
        submit_all(*writer, job);
        while (writer->counts().samples_committed < 13000) std::this_thread::yield();
        EXPECT_EQ(latent::testing::read_text(name_), finished);
        writer.reset();  // as if it was killed
        EXPECT_EQ(latent::testing::read_text(name_), finished);

        writer = open(job, {0, 13000});
        EXPECT_TRUE(writer->missing().empty());
        ASSERT_TRUE(writer->finish());
        EXPECT_EQ(runs_of(name_), undisturbed(job, {0, 13000}));
        EXPECT_TRUE(attempts_of(name_).empty());
        EXPECT_TRUE(open(job, before)->missing().empty());
    }
}

TEST_F(PartWriterTest, TwoWritersExtendAPartEachAsFarAsItIsToGo) {
    const Job job = make_short_job();
    auto first = open(job, {0, 4096});
    submit_all(*first, job);
    ASSERT_TRUE(first->finish());
    auto shorter = open(job, {0, 8192}), longer = open(job, {0, 12288});
    submit_all(*longer, job);
    submit_all(*shorter, job);
    ASSERT_TRUE(shorter->finish());
    EXPECT_EQ(runs_of(name_), undisturbed(job, {0, 8192}));
    ASSERT_TRUE(longer->finish());
    EXPECT_EQ(runs_of(name_), undisturbed(job, {0, 12288}));
    EXPECT_TRUE(attempts_of(name_).empty());
}

TEST_F(PartWriterTest, PublishingLeavesAttemptsAlongThatHoldMore) {
    const Job job = make_short_job();
    auto longer = open(job, {0, 8192});
    submit_all(*longer, job);
    while (longer->counts().samples_committed < 8192) std::this_thread::yield();
    longer.reset();
    const auto shorter = open(job, {0, 4096});
    EXPECT_TRUE(shorter->missing().empty());
    ASSERT_TRUE(shorter->finish());
    EXPECT_EQ(runs_of(name_), undisturbed(job, {0, 4096}));
    EXPECT_EQ(attempts_of(name_).size(), 1u);
}

TEST_F(PartWriterTest, AttemptsThatHoldNothingReadableArePassedOver) {
    const Job job = make_short_job();
    std::ofstream(name_.string() + ".part.0000000000000000");
    std::ofstream(name_.string() + ".part.0000000000000001") << "not ours";
    auto writer = open(job, {0, 4096});
    submit_all(*writer, job);
    ASSERT_TRUE(writer->finish());
    EXPECT_EQ(runs_of(name_), undisturbed(job, {0, 4096}));
    EXPECT_TRUE(fs::exists(name_.string() + ".part.0000000000000001"));  // not a file of this job: not ours to remove
}

TEST_F(PartWriterTest, ACommittedRunWithOneFlippedByteIsRenderedAgain) {
    const Job job = make_short_job();
    const SampleRange range{0, 3 * 4096 + 2048};
    const std::vector<RunContent> expected = undisturbed(job, range);
    for (const double place : {0.001, 0.01, 0.3, 0.7, 0.95}) {  // of the run: its header, pages, index
        for (const std::size_t run : {0, 2, 3}) {               // 3: a checkpoint, whose grains are taken up
            SCOPED_TRACE(fmt::format("run {}, at {}", run, place));
            auto first = open(job, range);
            const std::vector<SampleRange> grains = grains_of(first->missing());
            for (std::size_t i = 0; i + 1 < grains.size(); ++i) ASSERT_TRUE(first->submit(make_grain(job, grains[i])));
            ASSERT_TRUE(first->checkpoint());
            first.reset();
            const fs::path attempt = attempts_of(name_).at(0);
            const Result<FoundFile> committed = open_file(attempt);
            ASSERT_TRUE(committed);
            ASSERT_EQ(committed->contents.runs.size(), 4u);
            const RunInfo hit = committed->contents.runs[run];
            const auto at =
                static_cast<std::streamoff>(static_cast<double>(hit.header.index_offset() + hit.header.index_size()) * place);
            std::fstream file(attempt, std::ios::in | std::ios::out | std::ios::binary);
            file.seekg(static_cast<std::streamoff>(hit.offset) + at);
            const char flipped = static_cast<char>(file.get() ^ 0x10);
            file.seekp(static_cast<std::streamoff>(hit.offset) + at);
            file.put(flipped);
            file.close();

            const auto second = open(job, range);
            Coverage lost({grains.back().first, range.end});
            lost.add(hit.header.samples);
            EXPECT_EQ(second->missing(), lost);
            submit_all(*second, job);
            ASSERT_TRUE(second->finish());
            EXPECT_EQ(folder_.names(), std::vector<std::string>{"night.latent"});
            EXPECT_EQ(runs_of(name_), expected);
            EXPECT_TRUE(open_file(name_, VerifyLevel::kFull)->contents.damage.empty());
            fs::remove(name_);
        }
    }
}

TEST_F(PartWriterTest, AnEmptyShardIsAValidPart) {
    const Job job = make_short_job();
    for (int again = 0; again < 2; ++again) {
        const auto writer = open(job, {8192, 8192});
        EXPECT_TRUE(writer->missing().empty());
        ASSERT_TRUE(writer->finish());
        EXPECT_TRUE(runs_of(name_).empty());
    }
}

TEST_F(PartWriterTest, ARangeMayBeginInsideARunAndItsFirstRunEndsAtTheNextBoundary) {
    const Job job = make_short_job();
    auto writer = open(job, {5000, 13000});
    EXPECT_EQ(writer->missing(), Coverage(SampleRange{5000, 13000}));
    submit_all(*writer, job);
    while (writer->counts().samples_committed < 13000 - 5000) std::this_thread::yield();
    writer.reset();  // before it is finished
    writer = open(job, {5000, 13000});
    EXPECT_TRUE(writer->missing().empty());
    ASSERT_TRUE(writer->finish());
    EXPECT_EQ(runs_of(name_), undisturbed(job, {5000, 13000}));
    RunSetOptions options;
    options.inputs = {name_};
    const auto run_set = RunSet::open(options);
    ASSERT_TRUE(run_set);
    ASSERT_EQ((*run_set)->runs().size(), 3u);
    EXPECT_EQ((*run_set)->runs()[0].header.samples, (SampleRange{5000, 8192}));
    EXPECT_EQ((*run_set)->runs()[2].header.samples, (SampleRange{12288, 13000}));
}

TEST_F(PartWriterTest, ARangeOfMoreRunsThanAFileTakesIsRefusedBeforeAnythingIsRendered) {
    const Job job = make_short_job();
    const std::uint64_t most = kMaxRunsPerFile * job.run_samples;
    const Error refused = refusal(job, {job.run_samples, most + job.run_samples + 1});
    EXPECT_EQ(refused.code, ErrorCode::kUsage);
    EXPECT_NE(refused.message.find("more than 1048576 runs"), std::string::npos) << refused.message;
    EXPECT_EQ(open(job, {job.run_samples, most + job.run_samples})->missing().size(), most);
    EXPECT_TRUE(folder_.names().empty());
}

TEST_F(PartWriterTest, GrainsThatAreNotMissingOrNotGrainsAreRefused) {
    const Job job = make_short_job();
    const SampleRange range{0, 9000};
    const auto writer = open(job, range);
    ASSERT_TRUE(writer->submit(make_grain(job, {0, 1024})));
    for (const SampleRange wrong :
         {SampleRange{0, 1024}, {1024, 3072}, {1024, 2000}, {1025, 2049}, {8192, 9216}, {9216, 10240}, {2048, 2048}}) {
        const Status refused = writer->submit({wrong, {}});
        EXPECT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::kOutOfRange);
    }
    EXPECT_EQ(writer->finish().error().code, ErrorCode::kUsage);  // samples are missing still
    for (std::uint64_t first = 1024; first < 9000; first += 1024) {
        ASSERT_TRUE(writer->submit(make_grain(job, grain_range(first, range))));
    }
    EXPECT_TRUE(writer->finish());
}

TEST_F(PartWriterTest, RecordsThatDoNotFitStopTheWriterForGoodAndKeepWhatWasCommitted) {
    const Job job = make_short_job();
    auto writer = open(job, {0, 8192});
    for (std::uint64_t first = 0; first < 4096; first += 1024) ASSERT_TRUE(writer->submit(make_grain(job, {first, first + 1024})));
    ASSERT_TRUE(writer->checkpoint());
    Grain astray = make_grain(job, {4096, 5120});
    astray.records.sample[3] = 77;
    ASSERT_TRUE(writer->submit(std::move(astray)));
    const Status refused = writer->checkpoint();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kOutOfRange);
    EXPECT_FALSE(writer->submit(make_grain(job, {5120, 6144})));
    EXPECT_FALSE(writer->finish());
    writer.reset();
    EXPECT_EQ(open(job, {0, 8192})->missing(), Coverage(SampleRange{4096, 8192}));
}

// A grain of 3.3 MB.
Grain big_grain(const Job& job, std::uint64_t first) {
    Grain grain{{first, first + 1024}, {}};
    const Records one = synthetic::make_records(job, {first, first + 1});
    for (int i = 0; i < 100000; ++i) grain.records.append(one, 0, 0);
    return grain;
}

// Waits until `number` stands still.
void settle(const std::atomic<int>& number) {
    for (int before = -1; number == 0 || number != before; std::this_thread::sleep_for(std::chrono::milliseconds(200)))
        before = number;
}

TEST_F(PartWriterTest, GrainsFarAheadWaitForTheOldestSoThatMemoryStaysBounded) {
    Job job = make_short_job();
    job.run_samples = 65536;
    const auto writer = open(job, {0, 65536});
    std::atomic<int> submitted = 0;
    std::thread ahead([&] {
        for (std::uint64_t first = 1024; first < 40 * 1024; first += 1024, ++submitted)
            EXPECT_TRUE(writer->submit(big_grain(job, first)));
    });
    settle(submitted);
    EXPECT_LE(submitted * big_grain(job, 0).records.raw_bytes(), std::uint64_t{64} << 20);
    ASSERT_TRUE(writer->submit(big_grain(job, 0)));
    ahead.join();
    EXPECT_EQ(submitted, 39);
}

// A grain takes a millisecond or more, the checkpoint interval is 50: nobody goes on when the oldest grain is overdue but who has
// it.
TEST_F(PartWriterTest, GrainsThatWaitForTheOldestAreAtStakeAsWell) {
    Job job = make_short_job();
    job.run_samples = 1 << 20;
    const auto writer = open(job, {0, 400 * 1024}, 0.05);
    std::atomic<int> submitted = 0;
    std::thread ahead([&] {
        for (std::uint64_t first = 1024; first < 400 * 1024; first += 1024, ++submitted) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            EXPECT_TRUE(writer->submit(make_grain(job, {first, first + 1024})));
        }
    });
    settle(submitted);
    EXPECT_LE(submitted, 50);
    ASSERT_TRUE(writer->submit(make_grain(job, {0, 1024})));
    ahead.join();
    EXPECT_EQ(submitted, 399);
    ASSERT_TRUE(writer->finish());
}

TEST_F(PartWriterTest, GivingUpWakesThoseWhoWaitForAGrainThatWillNotCome) {
    Job job = make_short_job();
    job.run_samples = 65536;
    const auto writer = open(job, {0, 65536});
    ASSERT_TRUE(writer->submit(big_grain(job, 0)));
    std::atomic<int> submitted = 0;
    std::thread ahead([&] {
        for (std::uint64_t first = 2048;; first += 1024, ++submitted) {
            const Status status = writer->submit(big_grain(job, first));
            if (status) continue;
            EXPECT_EQ(status.error().code, ErrorCode::kStopped);
            return;
        }
    });
    settle(submitted);
    writer->give_up();
    ahead.join();
    ASSERT_TRUE(writer->checkpoint());
    EXPECT_EQ(writer->counts().samples_committed, 1024u);
}

}  // namespace
}  // namespace latent::sampledb
