#include "tools/merge/merge.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "tests/faults/process.h"
#include "tests/support/opened_runs.h"
#include "tests/support/synthetic.h"

namespace latent::merge {
namespace {

namespace fs = std::filesystem;
using namespace sampledb;
using namespace latent::testing;

using synthetic::make_short_job;
using synthetic::open_runs;
using synthetic::runs_between;
using synthetic::runs_of;

constexpr std::uint64_t kS = synthetic::kShortRun;

class MergeTest : public ::testing::Test {
 protected:
    TemporaryFolder folder_;
    const fs::path out_ = folder_ / "out.latent";

    fs::path part(const std::string& name, const Job& job, const std::vector<Coverage>& runs, bool footer = true) {
        const fs::path path = folder_ / name;
        synthetic::write_file(path, synthetic::make_file(job, runs, footer, {}, R"({"part":")" + name + "\"}").bytes);
        return path;
    }
    std::vector<std::string> command(const std::vector<fs::path>& inputs, const std::vector<std::string>& options = {}) const {
        std::vector<std::string> words = {tool("latent-merge"), "-o", out_.string()};
        for (const fs::path& input : inputs) words.push_back(input.string());
        words.insert(words.end(), options.begin(), options.end());
        return words;
    }
    Outcome merge_files(const std::vector<fs::path>& inputs, const std::vector<std::string>& options = {}) const {
        return run(command(inputs, options));
    }
    // Fails with one line that contains all of these words, and leaves no output.
    void expect_refusal(const std::vector<fs::path>& inputs, const std::vector<std::string>& words,
                        const std::vector<std::string>& options = {}) {
        const std::vector<std::string> before = folder_.names();
        const Outcome outcome = merge_files(inputs, options);
        EXPECT_EQ(outcome.status, 1) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        for (const std::string& word : words)
            EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " in: " << outcome.err;
        EXPECT_EQ(folder_.names(), before);
    }
};

TEST_F(MergeTest, TheOutputIsTheSameToTheLastByteWhateverTheOrderOfTheParts) {
    const Job job = make_short_job();
    std::vector<fs::path> parts = {part("a.latent", job, runs_between({0, kS, 2 * kS})),
                                   part("b.latent", job, runs_between({2 * kS, 3 * kS})),
                                   part("c.latent", job, runs_between({3 * kS, 4 * kS, 4 * kS + 1500}))};
    std::string expected;
    do {
        const Outcome outcome = merge_files(parts, {"--force"});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        if (expected.empty()) expected = read_text(out_);
        EXPECT_EQ(read_text(out_), expected);
    } while (std::next_permutation(parts.begin(), parts.end()));
}

TEST_F(MergeTest, AnyGroupingSelectsTheRunsThatOneProcessWouldHaveWritten) {
    const Job job = make_short_job(RecordKind::kSpectral);
    const fs::path a = part("a.latent", job, runs_between({0, kS})), b = part("b.latent", job, runs_between({kS, 2 * kS})),
                   c = part("c.latent", job, runs_between({2 * kS, 3 * kS, 3 * kS + 77}));
    const fs::path whole = part("whole.latent", job, runs_between({0, kS, 2 * kS, 3 * kS, 3 * kS + 77}));
    const fs::path ab = folder_ / "ab.latent", ba = folder_ / "ba.latent";
    for (const auto& [inputs, output] : {std::pair(std::vector{a, b}, ab), std::pair(std::vector{b, c}, ba)}) {
        MergeOptions options;
        options.inputs = inputs;
        options.output = output;
        ASSERT_TRUE(merge(options));
    }
    for (const std::vector<fs::path>& inputs : {std::vector{ab, c}, std::vector{ba, a}, std::vector{c, b, a}}) {
        const Outcome outcome = merge_files(inputs, {"--force"});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(runs_of(out_), runs_of(whole));
        EXPECT_EQ(open_runs({out_})->light_paths(), 3 * kS + 77);
    }
}

TEST_F(MergeTest, CheckpointsThatACanonicalRunSupersedesAreDropped) {
    const Job job = make_short_job();
    const fs::path with = part("a.latent.part.0123456789abcdef", job,
                               {Coverage(SampleRange{0, 1024}), Coverage(SampleRange{1024, 2048}), Coverage(SampleRange{0, kS}),
                                Coverage(SampleRange{kS, kS + 1024})},
                               false);
    ASSERT_EQ(merge_files({with}).status, 0);
    const std::vector<synthetic::RunContent> runs = runs_of(out_);
    ASSERT_EQ(runs.size(), 2u);
    EXPECT_EQ(runs[0].coverage, Coverage(SampleRange{0, kS}));
    EXPECT_EQ(runs[1].coverage, Coverage(SampleRange{kS, kS + 1024}));
    EXPECT_LT(fs::file_size(out_), fs::file_size(with));
}

TEST_F(MergeTest, WhatWouldCountASampleTwiceIsRefusedNamingBothFiles) {
    const Job job = make_short_job();
    const fs::path a = part("a.latent", job, runs_between({0, kS, 2 * kS})),
                   overlapping = part("b.latent", job, runs_between({kS, 2 * kS, 3 * kS}));
    expect_refusal({a, a}, {"a.latent"});
    expect_refusal({a, overlapping}, {"a.latent", "b.latent"});
    EXPECT_EQ(merge_files({a, a}, {"--skip-duplicates"}).status, 0);
    EXPECT_EQ(runs_of(out_), runs_of(a));
    EXPECT_EQ(merge_files({a, overlapping}, {"--skip-duplicates", "--force"}).status, 0);
    EXPECT_EQ(open_runs({out_})->coverage(), Coverage(SampleRange{0, 3 * kS}));
}

TEST_F(MergeTest, WhatIsNoPartOfTheJobIsRefusedByName) {
    const Job job = make_short_job();
    const fs::path a = part("a.latent", job, runs_between({0, kS})),
                   other = part("other.latent", make_short_job(RecordKind::kXyz, 2), runs_between({kS, 2 * kS}));
    std::ofstream(folder_ / "text.latent") << std::string(10000, 'x') << "this is a text file\n";
    expect_refusal({a, other}, {"a.latent", "other.latent", "job"});
    expect_refusal({a, folder_ / "text.latent"}, {"text.latent"});
    ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);  // nobody writes to it: reading it would wait for ever
    expect_refusal({a, folder_ / "pipe"}, {"pipe: not a regular file"});
    expect_refusal({a, "/dev/null"}, {"/dev/null: not a regular file"});
    expect_refusal({a, ""}, {"empty file name"});
    expect_refusal({a, folder_ / "nowhere.latent"}, {"nowhere.latent"});
    expect_refusal({folder_ / "text.latent"}, {"text.latent"});
    expect_refusal({a}, {"no file belongs to job", to_hex(job.id)}, {"--job", std::string(32, '7')});
}

TEST_F(MergeTest, ATruncatedPartYieldsItsGoodRunsAndExitStatusThree) {
    const Job job = make_short_job();
    const fs::path a = part("a.latent", job, runs_between({0, kS}));
    const synthetic::FileBytes file = synthetic::make_file(job, runs_between({kS, 2 * kS, 3 * kS}));
    synthetic::write_file(folder_ / "cut.latent", ByteSpan(file.bytes).first(file.run_ends[0] + 5000));
    const Outcome outcome = merge_files({a, folder_ / "cut.latent"});
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    EXPECT_NE(outcome.err.find("cut.latent"), std::string::npos) << outcome.err;
    EXPECT_EQ(open_runs({out_})->coverage(), Coverage(SampleRange{0, 2 * kS}));
}

TEST_F(MergeTest, PartsOfWhichNothingIsLeftGiveNoOutputButEmptyPartsGiveAnEmptyPart) {
    const Job job = make_short_job();
    const synthetic::FileBytes file = synthetic::make_file(job, runs_between({0, kS}));
    synthetic::write_file(folder_ / "cut.latent", ByteSpan(file.bytes).first(file.run_ends[0] - 5000));
    const fs::path empty = part("empty.latent", job, {});
    expect_refusal({folder_ / "cut.latent"}, {"cut.latent: truncated or damaged at its end", "no runs left to merge"});
    expect_refusal({folder_ / "cut.latent", empty}, {"cut.latent: truncated or damaged at its end", "no runs left to merge"});
    EXPECT_EQ(merge_files({empty}).status, 0);
    EXPECT_TRUE(open_runs({out_})->runs().empty());
}

TEST_F(MergeTest, AFolderGivesItsPartsAndAListOfWhatWasLeftOut) {
    const Job job = make_short_job();
    fs::create_directories(folder_ / "parts");
    part("parts/a.latent", job, runs_between({0, kS}));
    part("parts/again.latent", job, runs_between({0, kS}));
    part("parts/b.latent.part.0123456789abcdef", job, runs_between({kS, 2 * kS}), false);
    EXPECT_EQ(merge_files({folder_ / "parts"}).status, 0);  // repeats in a folder are normal
    EXPECT_EQ(open_runs({out_})->coverage(), Coverage(SampleRange{0, 2 * kS}));
    std::ofstream(folder_ / "parts/notes.latent") << "these are notes";
    const Outcome outcome = merge_files({folder_ / "parts"}, {"--force"});
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    EXPECT_NE(outcome.err.find("notes.latent"), std::string::npos) << outcome.err;
    EXPECT_EQ(open_runs({out_})->coverage(), Coverage(SampleRange{0, 2 * kS}));
}

TEST_F(MergeTest, ANameInANoteCannotSteerATerminal) {
    part("a\x1b[2J.latent.part.0123456789abcdef", make_short_job(), runs_between({0, kS}), false);
    std::ofstream(folder_ / "a\x1b[2J.latent.part.0123456789abcdef", std::ios::app) << "a write that was cut short";
    const Outcome outcome = merge_files({folder_.path()});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("note: "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("a\\x1b[2J"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find('\x1b'), std::string::npos);
}

TEST_F(MergeTest, ALongReportThatCannotBeWrittenIsLostTooAndTheOutputKept) {
    fs::create_directories(folder_ / "parts");
    part("parts/a.latent", make_short_job(), runs_between({0, kS}));
    for (int i = 0; i < 200; ++i) std::ofstream(folder_ / ("parts/text" + std::to_string(i))) << "no samples";
    const Outcome outcome = run({"/bin/sh", "-c", "exec \"$0\" \"$@\" > /dev/full", tool("latent-merge"), folder_ / "parts", "-o",
                                 out_.string(), "--json"});
    EXPECT_EQ(outcome.status, 3);
    EXPECT_NE(outcome.err.find("standard output: cannot write"), std::string::npos) << outcome.err;
    EXPECT_TRUE(fs::exists(out_));
}

TEST_F(MergeTest, AnOutputThatExistsIsKeptUnlessForced) {
    const fs::path a = part("a.latent", make_short_job(), runs_between({0, kS}));
    std::ofstream(out_) << "precious";
    expect_refusal({a}, {"out.latent", "--force"});
    EXPECT_EQ(read_text(out_), "precious");
    EXPECT_EQ(merge_files({a}, {"--force"}).status, 0);
    EXPECT_EQ(runs_of(out_), runs_of(a));
}

TEST_F(MergeTest, RequiredSamplesThatAreMissingAreNamed) {
    const fs::path a = part("a.latent", make_short_job(), {Coverage(SampleRange{0, kS}), Coverage(SampleRange{2 * kS, 3 * kS})});
    expect_refusal({a}, {"4096:8192"}, {"--require", "0:12288"});
    EXPECT_EQ(merge_files({a}, {"--require", "8192:12288"}).status, 0);
}

TEST_F(MergeTest, WrongUsageIsExitStatusTwo) {
    EXPECT_EQ(run({tool("latent-merge")}).status, 2);
    EXPECT_EQ(run({tool("latent-merge"), "a.latent"}).status, 2);
    EXPECT_EQ(merge_files({"a.latent"}, {"--require", "7:7"}).status, 2);
    EXPECT_EQ(merge_files({"a.latent"}, {"--verify", "never"}).status, 2);
}

TEST_F(MergeTest, ManyPartsNeedFewOpenFiles) {
    Job job = make_short_job();
    job.run_samples = 1024;
    fs::create_directories(folder_ / "parts");
    for (std::uint64_t i = 0; i < 600; ++i) {
        part("parts/" + std::to_string(i) + ".latent", job, {Coverage(SampleRange{i * 1024, i * 1024 + 1024})});
    }
    const Outcome outcome = run({"/bin/sh", "-c", "ulimit -n 300; exec \"$0\" \"$@\"", tool("latent-merge"),
                                 (folder_ / "parts").string(), "-o", out_.string()});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(open_runs({out_}, VerifyLevel::kHeaders)->coverage(), Coverage(SampleRange{0, 600 * 1024}));
}

class MergeFaults : public MergeTest {
 protected:
    const Job job_ = make_short_job();
    const std::vector<fs::path> parts_ = {part("a.latent", job_, runs_between({0, kS, 2 * kS})),
                                          part("b.latent", job_, runs_between({2 * kS, 3 * kS}))};
    const std::vector<std::string> before_ = folder_.names();

    FaultOutcome merge_with(const std::string& rule, const std::vector<std::string>& options) {
        return run_with_fault(command(parts_, options), {rule, folder_.path().string()});
    }
};

TEST_F(MergeFaults, EveryCallThatFailsIsReportedAndLeavesNoHalfOutput) {
    for (const std::vector<std::string>& options : {std::vector<std::string>{}, {"--compact"}}) {
        for (const char* call : {"create", "write", "copy", "sync", "link"}) {
            if (!options.empty() && std::string(call) == "copy") continue;  // everything is rewritten
            for (const char* what : {"EIO", "ENOSPC"}) {
                int nth = 1;
                for (bool happened = true; happened; ++nth) {
                    const std::string rule = std::string(call) + ":" + std::to_string(nth) + ":" + what;
                    SCOPED_TRACE(rule);
                    const FaultOutcome outcome = merge_with(rule, options);
                    happened = outcome.happened;
                    if (!happened) {
                        EXPECT_EQ(outcome.status, 0) << outcome.err;
                    } else if (outcome.status == 0 || fs::exists(out_)) {  // the folder's own sync, or a detour that worked
                        EXPECT_EQ(open_runs({out_})->coverage(), Coverage(SampleRange{0, 3 * kS}));
                    } else {
                        EXPECT_EQ(outcome.status, 1);
                        EXPECT_NE(outcome.err.find("out.latent"), std::string::npos) << outcome.err;
                        EXPECT_EQ(folder_.names(), before_);
                    }
                    fs::remove(out_);
                }
                EXPECT_GT(nth, 2) << call;
            }
        }
    }
}

TEST_F(MergeFaults, AReadErrorIsAnErrorNamingTheFileAndNeverDamage) {
    for (const std::vector<std::string>& options : {std::vector<std::string>{}, {"--compact"}}) {
        bool happened = true;
        for (int nth = 1; happened && nth < 200; ++nth) {
            const std::string rule = "read:" + std::to_string(nth) + ":EIO";
            SCOPED_TRACE(rule);
            const FaultOutcome outcome = merge_with(rule, options);
            happened = outcome.happened;
            if (!happened) {
                EXPECT_EQ(outcome.status, 0) << outcome.err;
                continue;
            }
            EXPECT_EQ(outcome.status, 1) << outcome.err;
            EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
            EXPECT_NE(outcome.err.find(".latent: cannot read"), std::string::npos) << outcome.err;
            EXPECT_EQ(folder_.names(), before_) << outcome.err;
        }
        fs::remove(out_);
        EXPECT_FALSE(happened);  // every read was met
    }
}

TEST_F(MergeFaults, AnyMeansOfCopyingGivesTheSameBytes) {
    ASSERT_EQ(merge_files(parts_).status, 0);
    const std::string expected = read_text(out_);
    for (const char* rule :
         {"copy:1:EXDEV", "copy:1+:EOPNOTSUPP", "copy:1:short", "copy:1:zero", "copy:2:EINTR", "write:1:short", "read:5:short"}) {
        fs::remove(out_);
        const FaultOutcome outcome = merge_with(rule, {});
        EXPECT_TRUE(outcome.happened) << rule;
        EXPECT_EQ(outcome.status, 0) << rule << outcome.err;
        EXPECT_EQ(read_text(out_), expected) << rule;
    }
}

TEST_F(MergeFaults, ACopyThatIsNotTheOriginalIsNoticed) {
    for (const char* rule : {"copy:1:flip", "copy:2:flip"}) {
        for (const std::vector<std::string>& options : {std::vector<std::string>{}, {"--verify", "full"}}) {
            const FaultOutcome outcome = merge_with(rule, options);
            EXPECT_EQ(outcome.status, 1) << rule;
            EXPECT_NE(outcome.err.find("out.latent: run at byte "), std::string::npos) << outcome.err;
            EXPECT_NE(outcome.err.find("although the copied bytes are sound"), std::string::npos) << outcome.err;
            EXPECT_EQ(folder_.names(), before_);
        }
    }
}

TEST_F(MergeFaults, AFullDiskLeavesNoHalfOutput) {
    const latent::testing::SmallDisk disk(64 << 10);
    if (!disk.mounted()) GTEST_SKIP() << "mounting a tmpfs is not permitted here";
    for (const std::vector<std::string>& options : {std::vector<std::string>{}, {"--compact"}, {"--force"}}) {
        std::vector<std::string> words = command(parts_, options);
        words[2] = disk / "out.latent";
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 1);
        EXPECT_NE(outcome.err.find("out.latent: cannot write: No space left on device"), std::string::npos) << outcome.err;
        EXPECT_TRUE(disk.names().empty());
    }
}

}  // namespace
}  // namespace latent::merge
