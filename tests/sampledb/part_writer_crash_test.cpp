// A part survives what may happen to a process and its disk: SIGKILL at any moment, and every system call failing once.
#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <sstream>
#include <thread>

#include "tests/faults/process.h"
#include "tests/support/opened_runs.h"

namespace latent::sampledb {
namespace {

namespace fs = std::filesystem;
using namespace latent::testing;

struct Setting {
    std::uint64_t samples, run_samples;
    double checkpoint_seconds;
    int microseconds_per_grain;
    bool spectral;
};

std::vector<std::string> writer(const fs::path& name, const Setting& setting, int job) {
    std::vector<std::string> command = {tool("slow_writer"),
                                        name.string(),
                                        std::to_string(setting.samples),
                                        std::to_string(setting.run_samples),
                                        std::to_string(setting.checkpoint_seconds),
                                        std::to_string(setting.microseconds_per_grain),
                                        std::to_string(job)};
    if (setting.spectral) command.push_back("spectral");
    return command;
}

// What readers see under the name: NAME.latent or its attempts. Every run is read in full.
struct Seen {
    std::uint64_t samples = 0;
    std::vector<synthetic::RunContent> runs;
};
Seen seen(const fs::path& name) {
    RunSetOptions options;
    options.inputs = {name};
    options.verify = VerifyLevel::kFull;
    const auto run_set = RunSet::open(options);
    Seen result;
    if (!run_set) return result;  // nothing readable yet
    EXPECT_TRUE((*run_set)->report().left_out.empty()) << (*run_set)->report().left_out.front().reason;
    result.samples = (*run_set)->coverage().size();
    result.runs = synthetic::runs_of(**run_set);
    return result;
}

// The last number that a writer reported under this word.
std::uint64_t last(const std::string& out, const std::string& wanted) {
    std::istringstream lines(out);
    std::string word;
    std::uint64_t number = 0, found = 0;
    while (lines >> word >> number) {
        if (word == wanted) found = number;
    }
    return found;
}

// Kills `writers` processes at a time at random moments, again and again, `kills` times in all; each job then ends undisturbed.
void kill_again_and_again(const Setting& setting, int writers, int kills, unsigned seed) {
    std::mt19937 random(seed);
    for (int killed = 0, job = 1; killed < kills; ++job) {
        const TemporaryFolder folder;
        const fs::path name = folder / "a.latent";
        std::uint64_t promised = 0;
        for (; killed < kills && !fs::exists(name); ++killed) {
            std::vector<std::unique_ptr<Child>> children;
            for (int i = 0; i < writers; ++i) children.push_back(std::make_unique<Child>(writer(name, setting, job)));
            for (const auto& child : children) {
                std::this_thread::sleep_for(std::chrono::microseconds(random() % 60000));
                child->kill_now();
                promised = std::max(promised, last(child->drain(), "committed"));
                child->wait();
            }
            ASSERT_GE(seen(name).samples, promised);  // nothing that was reported as committed is lost
        }
        std::vector<std::unique_ptr<Child>> last;
        for (int i = 0; i < writers; ++i) last.push_back(std::make_unique<Child>(writer(name, setting, job)));
        for (const auto& child : last) {
            child->drain();
            ASSERT_EQ(child->wait(), 0);
        }
        EXPECT_EQ(folder.names(), std::vector<std::string>{"a.latent"});
        const fs::path undisturbed = folder / "b.latent";
        ASSERT_EQ(run(writer(undisturbed, {setting.samples, setting.run_samples, 1000, 0, setting.spectral}, job)).status, 0);
        EXPECT_EQ(seen(name).runs, seen(undisturbed).runs);
    }
}

TEST(PartWriterKilled, ManyShortRuns) { kill_again_and_again({131072, 4096, 0.02, 400, false}, 1, 25, 1); }
TEST(PartWriterKilled, RunsThatTakeLongerThanTheCheckpointInterval) {
    kill_again_and_again({131072, 65536, 0.005, 400, false}, 1, 25, 2);
}
TEST(PartWriterKilled, SpectralRecords) { kill_again_and_again({65536, 16384, 0.01, 400, true}, 1, 15, 3); }
TEST(PartWriterKilled, TwoWritersAtOnce) { kill_again_and_again({131072, 16384, 0.01, 400, false}, 2, 20, 4); }

// Every fdatasync takes 0.2 s, four times the interval; a grain takes 0.4 ms or more. So no more than 0.05 / 0.0004 grains can be
// finished in an interval, and the one that finds the checkpoint late.
TEST(PartWriterOnASlowDisk, RenderingWaitsSoThatNoMoreThanAnIntervalIsAtStake) {
    for (const std::uint64_t run_samples : {65536ul, 1ul << 22}) {
        const TemporaryFolder folder;
        const Setting setting{800'000, run_samples, 0.05, 400, false};
        const FaultOutcome outcome =
            run_with_fault(writer(folder / "a.latent", setting, 1), {"sync:1+:slow", folder.path().string()});
        EXPECT_TRUE(outcome.happened);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_GT(last(outcome.out, "uncommitted"), 0u);
        EXPECT_LE(last(outcome.out, "uncommitted"), 126u * 1024);
    }
}

class PartWriterFaults : public ::testing::Test {
 protected:
    const Setting setting_{16384, 4096, 0.002, 200, false};
    TemporaryFolder folder_;
    const fs::path name_ = folder_ / "a.latent";
    const std::vector<synthetic::RunContent> expected_ = [this] {
        const TemporaryFolder other;
        EXPECT_EQ(run(writer(other / "a.latent", setting_, 1)).status, 0);
        return seen(other / "a.latent").runs;
    }();

    FaultOutcome write_with(const std::string& rule) {
        return run_with_fault(writer(name_, setting_, 1), {rule, folder_.path().string()});
    }
    void finish_undisturbed() {
        const Outcome again = run(writer(name_, setting_, 1));
        EXPECT_EQ(again.status, 0) << again.err;
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.latent"});
        EXPECT_EQ(seen(name_).runs, expected_);
        for (const std::string& left : folder_.names()) fs::remove(folder_ / left);
    }
};

TEST_F(PartWriterFaults, EveryCallThatFailsIsReportedAndTheSameCommandGoesOn) {
    for (const char* call : {"create", "write", "sync", "link"}) {
        for (const char* what : {"EIO", "ENOSPC"}) {
            int nth = 1;
            for (bool happened = true; happened && nth < 40; ++nth) {
                const std::string rule = std::string(call) + ":" + std::to_string(nth) + ":" + what;
                SCOPED_TRACE(rule);
                const FaultOutcome outcome = write_with(rule);
                happened = outcome.happened;
                if (!happened) {
                    EXPECT_EQ(outcome.status, 0) << outcome.err;
                } else if (fs::exists(name_)) {  // the name was given; only its own survival of a power cut was in doubt
                    EXPECT_EQ(seen(name_).runs, expected_);
                } else {
                    EXPECT_EQ(outcome.status, 1);
                    EXPECT_NE(outcome.err.find(folder_.path().string()), std::string::npos) << outcome.err;
                    EXPECT_GE(seen(name_).samples, last(outcome.out, "committed"));
                }
                finish_undisturbed();
            }
            EXPECT_GT(nth, 2) << call;  // each kind of call was met
        }
    }
}

TEST_F(PartWriterFaults, ShortWritesAndInterruptionsAreOvercome) {
    for (const char* rule : {"write:1:short", "write:2+:short", "write:3:EINTR", "write:5:short"}) {
        const FaultOutcome outcome = write_with(rule);
        EXPECT_TRUE(outcome.happened) << rule;
        EXPECT_EQ(outcome.status, 0) << rule << outcome.err;
        finish_undisturbed();
    }
}

TEST_F(PartWriterFaults, KilledBeforeOrAfterAnyCallItGoesOn) {
    for (const char* call : {"create", "write", "sync", "link", "unlink"}) {
        for (const char* what : {"kill", "kill-after"}) {
            for (int nth = 1; nth < 6; ++nth) {
                const std::string rule = std::string(call) + ":" + std::to_string(nth) + ":" + what;
                SCOPED_TRACE(rule);
                const FaultOutcome outcome = write_with(rule);
                EXPECT_EQ(outcome.status, outcome.happened ? 128 + 9 : 0) << outcome.err;
                EXPECT_GE(seen(name_).samples, last(outcome.out, "committed"));
                finish_undisturbed();
            }
        }
    }
}

TEST_F(PartWriterFaults, WithoutHardLinksThePartIsRenamedAndWithoutEitherTheAttemptKeepsEverything) {
    for (const char* without : {"link:1:EPERM", "link:1:EPERM,renameat2:1+:EINVAL"}) {
        const FaultOutcome renamed = write_with(without);
        EXPECT_TRUE(renamed.happened);
        EXPECT_EQ(renamed.status, 0) << renamed.err;
        EXPECT_TRUE(fs::exists(name_)) << without;
        finish_undisturbed();
    }
    const FaultOutcome neither = write_with("link:1:EPERM,renameat2:1+:EIO");
    EXPECT_EQ(neither.status, 1);
    EXPECT_NE(neither.err.find("cannot name the finished file"), std::string::npos) << neither.err;
    EXPECT_FALSE(fs::exists(name_));
    EXPECT_EQ(seen(name_).runs, expected_);
    finish_undisturbed();
}

TEST_F(PartWriterFaults, AnExtensionThatIsKilledAtAnyCallLosesNothingAndGoesOn) {
    Setting shorter = setting_;
    shorter.samples = 6000;
    for (const char* call : {"create", "write", "sync", "link", "unlink"}) {
        for (const char* what : {"kill", "kill-after", "EPERM"}) {
            for (int nth = 1; nth < 6; ++nth) {
                const std::string rule = std::string(call) + ":" + std::to_string(nth) + ":" + what;
                SCOPED_TRACE(rule);
                ASSERT_EQ(run(writer(name_, shorter, 1)).status, 0);
                const FaultOutcome outcome = write_with(rule);
                const std::uint64_t kept = seen(folder_.path()).samples;  // the finished part, and attempts at a longer one
                EXPECT_GE(kept, std::max<std::uint64_t>(6000, last(outcome.out, "committed")));
                finish_undisturbed();
            }
        }
    }
}

TEST_F(PartWriterFaults, RunsOfOtherAttemptsAreAdoptedByAnyMeansOfCopying) {
    for (const char* rule : {"copy:1:EXDEV", "copy:1:short", "copy:1:zero", "copy:1:EIO", "copy:1:ENOSPC", "read:4:EIO"}) {
        SCOPED_TRACE(rule);
        EXPECT_EQ(write_with("link:1:kill").status, 128 + 9);  // everything is committed, nothing published
        const FaultOutcome outcome = write_with(rule);
        EXPECT_TRUE(outcome.happened);
        const bool must_fail = std::string(rule) == "copy:1:ENOSPC";  // after EIO the bytes are read and written through memory
        EXPECT_EQ(outcome.status, must_fail ? 1 : 0) << outcome.err;
        finish_undisturbed();
    }
}

TEST(PartWriterFullDisk, WhatWasCommittedStaysAndTheSameCommandGoesOnWhenThereIsRoom) {
    latent::testing::SmallDisk disk(400 << 10);
    if (!disk.mounted()) GTEST_SKIP() << "mounting a tmpfs is not permitted here";
    const fs::path name = disk / "a.latent";
    const Setting setting{131072, 16384, 0.005, 100, false};
    const Outcome full = run(writer(name, setting, 1));
    EXPECT_EQ(full.status, 1);
    EXPECT_NE(full.err.find("a.latent.part."), std::string::npos) << full.err;
    EXPECT_NE(full.err.find("No space left on device"), std::string::npos) << full.err;
    EXPECT_GT(last(full.out, "committed"), 0u);
    EXPECT_NE(full.err.find("committed work is kept"), std::string::npos) << full.err;
    EXPECT_GE(seen(name).samples, last(full.out, "committed"));
    EXPECT_FALSE(fs::exists(name));
    disk.resize(16 << 20);
    ASSERT_EQ(run(writer(name, setting, 1)).status, 0);
    const TemporaryFolder other;
    ASSERT_EQ(run(writer(other / "a.latent", setting, 1)).status, 0);
    EXPECT_EQ(seen(name).runs, seen(other / "a.latent").runs);
}

TEST(PartWriterFullDisk, NothingIsSaidToBeKeptWhereNothingIsCommitted) {
    const TemporaryFolder folder;
    const Setting setting{131072, 16384, 1000, 0, false};
    const FaultOutcome first = run_with_fault(writer(folder / "a.latent", setting, 1), {"write:2+:ENOSPC", folder.path().string()});
    EXPECT_TRUE(first.happened);
    EXPECT_EQ(first.status, 1);
    EXPECT_NE(first.err.find("; nothing is committed yet"), std::string::npos) << first.err;
    EXPECT_EQ(first.err.find("is kept"), std::string::npos) << first.err;
    EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace latent::sampledb
