// latent-render as a process that is killed: what ends up in the file is what an uninterrupted render writes, bit for bit.
#include <gmock/gmock.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <random>
#include <thread>

#include "sampledb/read/run_set.h"
#include "tests/faults/process.h"
#include "tests/support/paths.h"

namespace latent::render {
namespace {

using latent::testing::Child;
using latent::testing::Outcome;
using latent::testing::TemporaryFolder;
using latent::testing::tool;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Command = std::vector<std::string>;

// Checkpoints come as often as they can; the last run is cut.
Command command(const std::filesystem::path& output, const Command& more = {}, const std::string& samples = "0:150000") {
    Command out{tool("latent-render"),
                latent::testing::in_tree("scenes/cornell.pbrt"),
                "-o",
                output.string(),
                "--samples",
                samples,
                "--run-samples",
                "65536",
                "--checkpoint",
                "0.05"};
    out.insert(out.end(), more.begin(), more.end());
    return out;
}

// First sample, end and content of every selected run.
std::vector<std::string> runs_of(const std::vector<std::filesystem::path>& files) {
    sampledb::RunSetOptions options;
    options.inputs = files;
    const auto run_set = sampledb::RunSet::open(options);
    EXPECT_TRUE(run_set) << (run_set ? "" : run_set.error().message);
    std::vector<std::string> runs;
    if (!run_set) return runs;
    for (const sampledb::SelectedRun& run : (*run_set)->runs()) {
        runs.push_back(std::to_string(run.header.samples.first) + ":" + std::to_string(run.header.samples.end) + " " +
                       to_hex(run.header.content_hash));
    }
    return runs;
}

class Resume : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        const TemporaryFolder folder;
        const Outcome outcome = latent::testing::run(command(folder / "whole.latent"));
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        whole_ = runs_of({folder / "whole.latent"});
        whole_seconds_ = outcome.seconds;
        ASSERT_EQ(whole_.size(), 3u);
    }
    // Sleeps for a random part of the time that this machine takes for everything, times `factor`.
    void sleep_a_while(double factor = 1) {
        std::this_thread::sleep_for(
            std::chrono::duration<double>(std::uniform_real_distribution<double>(0, factor * whole_seconds_)(random_)));
    }
    static std::vector<std::string> whole_;
    static double whole_seconds_;
    TemporaryFolder folder_;
    std::mt19937 random_{3};
};
std::vector<std::string> Resume::whole_;
double Resume::whole_seconds_;

// Until some samples of the part are committed.
void wait_for_samples(const std::filesystem::path& part) {
    sampledb::RunSetOptions options;
    options.inputs = {part};
    for (;; std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
        const auto run_set = sampledb::RunSet::open(options);
        if (run_set && !(*run_set)->runs().empty()) return;
    }
}

TEST_F(Resume, KilledAtAnyMomentItEndsAsIfItNeverWas) {
    int kills = 0;
    for (int round = 0; kills < 40; ++round) {
        const std::filesystem::path part = folder_ / ("r" + std::to_string(round) + ".latent");
        for (int attempt = 0;; ++attempt) {
            ASSERT_LT(attempt, 200) << "it does not get on";
            Child child(command(part));
            sleep_a_while(0.5 + 0.1 * attempt);  // longer, should the machine be slower by now
            child.kill_now();
            const int status = child.wait();
            if (status == 0) break;
            ASSERT_EQ(status, 128 + SIGKILL);
            ++kills;
        }
        ASSERT_EQ(latent::testing::run(command(part)).status, 0);
        EXPECT_EQ(runs_of({part}), whole_);
        EXPECT_EQ(latent::testing::run({tool("latent-inspect"), "verify", part.string()}).status, 0);
    }
}

// What samples see is committed with them: by a lens that splits wavelengths, too, whose samples have many records.
TEST_F(Resume, KilledWithExtraColumnsItEndsAsIfItNeverWas) {
    const std::string scene = (folder_ / "lens.pbrt").string();
    std::ofstream(scene) << R"(LookAt 0 -3 1.2  0 0 .3  0 0 1
Camera "perspective" "float lensradius" .15 "float latent:focaldistances" [ 2 4 ]
WorldBegin
LightSource "infinite" "string name" "sky"
Shape "bilinearmesh" "point3 P" [ -9 -9 0  9 -9 0  -9 9 0  9 9 0 ]
Shape "sphere" "float radius" .4
)";
    const auto lens = [&](const std::string& output) -> Command {
        return {tool("latent-render"),
                scene,
                "-o",
                output,
                "--samples",
                "0:20000",
                "--run-samples",
                "8192",
                "--aov",
                "depth,normal,id",
                "--light-groups",
                "--checkpoint",
                "0.05"};
    };
    const std::string whole = (folder_ / "whole.latent").string(), part = (folder_ / "part.latent").string();
    const Outcome outcome = latent::testing::run(lens(whole));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    int kills = 0;
    for (int attempt = 0;; ++attempt) {
        ASSERT_LT(attempt, 200) << "it does not get on";
        Child child(lens(part));
        std::this_thread::sleep_for(std::chrono::duration<double>(outcome.seconds * (0.3 + 0.1 * attempt)));
        child.kill_now();
        if (child.wait() == 0) break;
        ++kills;
    }
    EXPECT_GT(kills, 0);
    EXPECT_EQ(runs_of({part}), runs_of({whole}));
    EXPECT_EQ(latent::testing::run({tool("latent-inspect"), "verify", "--deep", part}).status, 0);
}

TEST_F(Resume, TwoAtOnceOnOneNameDoNotDisturbEachOther) {
    const std::filesystem::path part = folder_ / "both.latent";
    for (int round = 0; round < 6; ++round) {
        Child a(command(part)), b(command(part));
        sleep_a_while();
        (round % 2 == 0 ? a : b).kill_now();
        sleep_a_while(0.5);
        (round % 2 == 0 ? b : a).kill_now();
        a.wait();
        b.wait();
    }
    Child a(command(part)), b(command(part));
    EXPECT_EQ(a.wait(), 0);
    EXPECT_EQ(b.wait(), 0);
    EXPECT_EQ(runs_of({part}), whole_);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"both.latent"});
}

TEST_F(Resume, SignalsStopItWithACheckpointAndAWayToGoOn) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2}) {
        const std::filesystem::path part = folder_ / ("s" + std::to_string(signal) + ".latent");
        Child child(command(part, {"--ignore-space"}, "0:60000000000"));
        wait_for_samples(part);  // its attempts are read under its name
        child.send(signal);
        child.send(signal);
        EXPECT_EQ(child.wait(), 75);
        EXPECT_FALSE(runs_of({part}).empty());
    }
}

TEST_F(Resume, ALogSaysWhatIsCommittedFromTheStart) {
    const std::filesystem::path part = folder_ / "l.latent", whole = folder_ / "w.latent";
    Child child(command(part, {"--ignore-space"}, "0:60000000000"));
    wait_for_samples(part);
    child.send(SIGUSR1);
    ASSERT_EQ(child.wait(), 75);
    const Outcome resumed = latent::testing::run(command(part, {"--ignore-space", "--max-time", "1e-9"}, "0:60000000000"));
    EXPECT_EQ(resumed.status, 75);
    EXPECT_THAT(resumed.err, ContainsRegex("^[-0-9]+ [:0-9]+ committed [1-9][0-9]* of 60000000000 samples \\(0.0 %\\)\n"));
    EXPECT_THAT(latent::testing::run(command(whole)).err, HasSubstr(" committed 150000 of 150000 samples (100.0 %), "));
    EXPECT_THAT(latent::testing::run(command(whole, {"--quiet", "--force"})).err, IsEmpty());
}

TEST_F(Resume, NohupOutlivesItsTerminal) {
    const std::filesystem::path part = folder_ / "n.latent";
    Command nohup = command(part);
    nohup.insert(nohup.begin(), "/usr/bin/nohup");
    Child child(nohup);
    wait_for_samples(part);
    child.send(SIGHUP);
    EXPECT_EQ(child.wait(), 0);
    EXPECT_EQ(runs_of({part}), whole_);
}

TEST_F(Resume, MaxTimeStopsWithStatus75AndALineThatSaysHow) {
    const std::filesystem::path part = folder_ / "t.latent";
    const Outcome stopped = latent::testing::run(command(part, {"--max-time", "1e-9"}));  // over when it begins
    EXPECT_EQ(stopped.status, 75);
    EXPECT_THAT(stopped.err, HasSubstr("0 of 150000 samples are committed; run the same command again to resume"));
    int status = 75;  // however long it takes, a tenth at a time
    for (const std::string tenth = std::to_string(whole_seconds_ / 10); status == 75;)
        status = latent::testing::run(command(part, {"--max-time", tenth})).status;
    EXPECT_EQ(status, 0);
    EXPECT_EQ(runs_of({part}), whole_);
}

TEST_F(Resume, ThreadsAndShardsMakeTheSameRuns) {
    ASSERT_EQ(latent::testing::run(command(folder_ / "one.latent", {"--threads", "1"})).status, 0);
    EXPECT_EQ(runs_of({folder_ / "one.latent"}), whole_);
    std::vector<std::filesystem::path> shards;
    for (int i = 3; i >= 0; --i) {  // three runs: one of the four is empty
        shards.push_back(folder_ / ("shard" + std::to_string(i) + ".latent"));
        const Outcome outcome = latent::testing::run(command(shards.back(), {"--shard", std::to_string(i) + "/4"}));
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        const Outcome again = latent::testing::run(command(shards.back(), {"--shard", std::to_string(i) + "/4"}));
        EXPECT_THAT(again.out, HasSubstr(i == 0 ? ", an empty shard, " : ", nothing left to render, "));
    }
    EXPECT_EQ(runs_of(shards), whole_);
}

TEST_F(Resume, MoreShardsThanRunsIsSaidWithAWayToGiveEveryShardWork) {
    const Outcome empty = latent::testing::run(command(folder_ / "0.latent", {"--shard", "0/4"}));
    EXPECT_EQ(empty.status, 0);
    EXPECT_THAT(empty.err,
                HasSubstr("warning: --shard 0/4: 1 of 4 shards are empty, including this one: 150000 samples make only 3 runs"));
    EXPECT_THAT(empty.err, HasSubstr("use --run-samples 32768 for every shard"));
    const Outcome other = latent::testing::run(command(folder_ / "1.latent", {"--shard", "1/4"}));
    EXPECT_THAT(other.err, HasSubstr("1 of 4 shards are empty: 150000 samples"));
    EXPECT_THAT(latent::testing::run(command(folder_ / "2.latent", {"--shard", "2/3"})).err, Not(HasSubstr("warning")));
}

TEST_F(Resume, AnOutputWithoutAFolderIsRefusedBeforeTheSceneIsRead) {
    std::ofstream(folder_ / "file") << "";
    for (const Command& more : {Command{}, Command{"--dry-run"}, Command{"--preview", "1"}}) {
        const Outcome missing = latent::testing::run(command(folder_ / "none/p.latent", more));
        EXPECT_EQ(missing.status, 1);
        EXPECT_THAT(missing.err, HasSubstr("none/p.latent: " + (folder_ / "none").string() + " does not exist\n"));
        const Outcome file = latent::testing::run(command(folder_ / "file/p.latent", more));
        EXPECT_EQ(file.status, 1);
        EXPECT_THAT(file.err, HasSubstr((folder_ / "file").string() + " is not a folder\n"));
    }
}

// /proc takes no files, not even from root.
TEST_F(Resume, ADryRunFailsAsTheRenderDoesWhereNothingCanBeWritten) {
    const Outcome render = latent::testing::run(command("/proc/p.latent")),
                  dry = latent::testing::run(command("/proc/p.latent", {"--dry-run"}));
    EXPECT_EQ(render.status, 1);
    EXPECT_EQ(dry.status, render.status);
    EXPECT_THAT(dry.err, ::testing::MatchesRegex(
                             "latent-render: /proc: cannot create a temporary file: [^\n]*; choose another folder with -o\n"));
    EXPECT_THAT(dry.out, IsEmpty());
}

// On a disk that holds a tenth of it.
TEST_F(Resume, APartThatWillNotFitIsRefusedBeforeItBegins) {
    const latent::testing::SmallDisk disk(2 << 20);
    if (!disk.mounted()) GTEST_SKIP() << "no right to mount a small disk";
    const Command part = command(disk / "p.latent");
    const auto with = [&part](const Command& more) {
        Command out = part;
        out.insert(out.end(), more.begin(), more.end());
        return latent::testing::run(out);
    };
    const Outcome dry = with({"--dry-run"});
    EXPECT_EQ(dry.status, 0);
    EXPECT_THAT(dry.err, HasSubstr("warning: "));
    EXPECT_THAT(dry.err, HasSubstr(" are free in "));
    const Outcome refused = with({});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.err, HasSubstr(" are free in "));
    EXPECT_THAT(refused.err, HasSubstr("--ignore-space"));
    EXPECT_EQ(std::ranges::count(refused.err, '\n'), 1);
    EXPECT_TRUE(disk.names().empty());
    EXPECT_EQ(with({"--max-time", "1e-9"}).status, 75);  // what can be rendered until then fits
    const Outcome full = with({"--ignore-space"});
    EXPECT_EQ(full.status, 1);
    EXPECT_THAT(full.err, HasSubstr("No space left"));
}

TEST_F(Resume, AFinishedPartIsExtendedToMoreSamples) {
    const std::filesystem::path part = folder_ / "p.latent";
    ASSERT_EQ(latent::testing::run(command(part, {}, "0:100000")).status, 0);
    EXPECT_NE(runs_of({part}), whole_);
    Child child(command(part));
    sleep_a_while();
    child.kill_now();
    child.wait();
    ASSERT_EQ(latent::testing::run(command(part)).status, 0);
    EXPECT_EQ(runs_of({part}), whole_);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"p.latent"});
    EXPECT_THAT(latent::testing::run(command(part, {}, "0:100000")).out, HasSubstr("nothing left to render"));
}

TEST_F(Resume, MoreThanBeginsWhereOtherFilesEnd) {
    const std::filesystem::path first = folder_ / "a.latent", rest = folder_ / "b.latent", whole = folder_ / "w.latent";
    const auto with = [&](const std::filesystem::path& output, const Command& more) {
        Command out{tool("latent-render"),
                    latent::testing::in_tree("scenes/cornell.pbrt"),
                    "-o",
                    output.string(),
                    "--resolution",
                    "100x100",
                    "--run-samples",
                    "4096"};
        out.insert(out.end(), more.begin(), more.end());
        return latent::testing::run(out);
    };
    ASSERT_EQ(with(first, {"--spp", "1"}).status, 0);
    for (int again = 0; again < 2; ++again) {  // the output among the files, as a glob would have it
        const Outcome more = with(rest, {"--spp", "3", "--more-than", first.string(), rest.string()});
        ASSERT_EQ(more.status, 0) << more.err;
        EXPECT_THAT(more.out, HasSubstr("samples 10000:30000"));
    }
    sampledb::RunSetOptions options;
    options.inputs = {first, rest};
    const auto run_set = sampledb::RunSet::open(options);
    ASSERT_TRUE(run_set) << run_set.error().message;
    EXPECT_EQ((*run_set)->coverage(), sampledb::Coverage(sampledb::SampleRange{0, 30000}));
    const Outcome enough = with(whole, {"--spp", "2", "--more-than", first.string(), rest.string()});
    EXPECT_EQ(enough.status, 2);
    EXPECT_THAT(enough.err, HasSubstr("use a larger --spp"));
    const Outcome other = with(whole, {"--spp", "5", "--seed", "3", "--more-than", first.string()});
    EXPECT_EQ(other.status, 1);
    EXPECT_THAT(other.err, HasSubstr("another job"));
    EXPECT_EQ(with(whole, {"--spp", "5", "--more-than", (folder_ / "none.latent").string()}).status, 1);
    EXPECT_EQ(with(whole, {"--samples", "0:4096", "--more-than", first.string()}).status, 2);
    EXPECT_FALSE(std::filesystem::exists(whole));
    // A folder and a pattern, with other things among the files, and an attempt at the output that ends after all of them.
    std::ofstream(folder_ / "log") << "text";
    ASSERT_EQ(with(folder_ / "other.latent", {"--spp", "9", "--seed", "3"}).status, 0);
    ASSERT_EQ(with(whole, {"--samples", "30000:40000"}).status, 0);
    std::filesystem::rename(whole, folder_ / "w.latent.part.0123456789abcdef");
    for (const std::filesystem::path& input : {folder_.path(), folder_ / "*"}) {
        const Outcome more = with(whole, {"--spp", "4", "--more-than", input.string()});
        ASSERT_EQ(more.status, 0) << more.err;
        EXPECT_THAT(more.out, HasSubstr("samples 30000:40000, nothing left to render"));
        std::filesystem::rename(whole, folder_ / "w.latent.part.0123456789abcdef");
    }
}

TEST_F(Resume, AnotherJobOrRangeUnderTheNameIsRefused) {
    const std::filesystem::path part = folder_ / "p.latent";
    ASSERT_EQ(latent::testing::run(command(part)).status, 0);
    const Outcome seed = latent::testing::run(command(part, {"--seed", "2"}));
    EXPECT_EQ(seed.status, 1);
    EXPECT_THAT(seed.err, HasSubstr("another job"));
    EXPECT_EQ(latent::testing::run(command(part, {}, "65536:250000")).status, 1);
    EXPECT_EQ(runs_of({part}), whole_);
    ASSERT_EQ(latent::testing::run(command(part, {"--seed", "2", "--force"})).status, 0);
    EXPECT_NE(runs_of({part}), whole_);
}

TEST_F(Resume, ADryRunWithoutAPlaceForItIsToldSo) {
    const Outcome outcome = latent::testing::run(command(folder_ / "x.latent", {"--dry-run"}), {{"TMPDIR", "/nonexistent"}});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("set TMPDIR"));
    EXPECT_TRUE(folder_.names().empty());
}

TEST_F(Resume, WrongUsageIsStatus2) {
    EXPECT_EQ(latent::testing::run({tool("latent-render")}).status, 2);
    EXPECT_EQ(latent::testing::run(command(folder_ / "x.latent", {"--shard", "4/4"})).status, 2);
    EXPECT_EQ(latent::testing::run(command(folder_ / "x.latent", {"--simd", "mmx"})).status, 2);
    EXPECT_EQ(latent::testing::run(command(folder_ / "x.latent", {"--seed", "-1"})).status, 2);
    EXPECT_EQ(latent::testing::run(command(folder_ / "x.foo")).status, 2);
    for (const char* option : {"--checkpoint", "--max-time"}) {
        for (const char* time : {"0", "0s", "-5", "inf", "nan", "5x", ""}) {
            const Outcome outcome = latent::testing::run({tool("latent-render"), latent::testing::in_tree("scenes/cornell.pbrt"),
                                                          "-o", (folder_ / "x.latent").string(), option, time});
            EXPECT_EQ(outcome.status, 2) << option << " " << time;
            EXPECT_THAT(outcome.err, HasSubstr(option));
        }
    }
    const latent::testing::Outcome misspelt = latent::testing::run({tool("latent-render"), "--hlep"});
    EXPECT_EQ(misspelt.status, 2);
    EXPECT_THAT(misspelt.err, HasSubstr("--hlep"));
    EXPECT_EQ(latent::testing::run({tool("latent-render"), "/nonexistent.pbrt", "-o", (folder_ / "x.latent").string()}).status, 1);
    EXPECT_TRUE(folder_.names().empty());
}

}  // namespace
}  // namespace latent::render
