// A thousand tasks of fifty machines that were killed, cut short, sent twice and mixed with files of other jobs: merge takes
// exactly the runs that are whole, and lists the rest with reasons.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include "base/json.h"
#include "tests/faults/process.h"
#include "tests/support/opened_runs.h"
#include "tests/support/synthetic.h"
#include "tools/merge/merge.h"

namespace latent::merge {
namespace {

namespace fs = std::filesystem;
using namespace sampledb;
using namespace latent::testing;

constexpr std::uint64_t kTasks = 1000, kRunsPerTask = 3, kMachines = 50;

Job small_job(std::uint64_t id) {
    Job job = synthetic::make_job(RecordKind::kXyz, id);
    job.run_samples = 1024;
    return job;
}

// A folder as rsync brings it together from fifty machines, and what is to be found in it.
class Night {
 public:
    explicit Night(const fs::path& folder) : folder_(folder) {
        fs::create_directories(folder / "logs");
        std::ofstream(folder / "logs/night.log") << "in a folder of its own\n";
        std::ofstream(folder / "host7.log") << "task 12 on host7\n";
        std::ofstream(folder / "preview.png") << "\x89PNG\r\n";
        ignored_ = {"logs", "host7.log", "preview.png"};
        for (std::uint64_t task = 0; task < kTasks; ++task) add(task);
    }

    Coverage coverage() const { return Coverage::of({runs_.begin(), runs_.end()}); }
    const std::set<SampleRange>& runs() const { return runs_; }
    const std::set<std::string>& damaged() const { return damaged_; }  // published, and not as they were
    const std::set<std::string>& ignored() const { return ignored_; }  // no loss: of another job, or no sample file at all

 private:
    SampleRange run(std::uint64_t task, std::uint64_t i) const {
        const std::uint64_t first = (task * kRunsPerTask + i) * 1024;
        return {first, first + 1024};
    }
    synthetic::FileBytes file(const Job& job, std::uint64_t task, std::uint64_t count, bool footer) const {
        std::vector<Coverage> runs;
        for (std::uint64_t i = 0; i < count; ++i) runs.emplace_back(run(task, i));
        return synthetic::make_file(job, runs, footer, {.light_per_sample = 0});
    }
    void write(const std::string& name, ByteSpan bytes) const { synthetic::write_file(folder_ / name, bytes); }
    // What is whole of a file that ends after `size` bytes.
    void count(const synthetic::FileBytes& file, std::uint64_t task, std::size_t size) {
        for (std::size_t i = 0; i < file.run_ends.size() && file.run_ends[i] <= size; ++i) runs_.insert(run(task, i));
    }

    // The part of a task, or what became of it.
    void add(std::uint64_t task) {
        const std::string name = fmt::format("part-{:05}.latent", task);
        const std::string host = fmt::format("host{}", random_() % kMachines);
        const synthetic::FileBytes whole = file(job_, task, kRunsPerTask, true);
        const auto random_size = [&] { return whole.header_size + random_() % (whole.bytes.size() - whole.header_size); };
        switch (random_() % 10) {
            case 0:  // killed in a run, and again; nobody went on
                for (int attempt = 0; attempt < 2; ++attempt) {
                    const synthetic::FileBytes open = file(job_, task, kRunsPerTask, false);
                    const std::size_t size = open.header_size + random_() % (open.bytes.size() - open.header_size);
                    write(fmt::format("{}.part.{:016x}", name, random_()), ByteSpan(open.bytes).first(size));
                    count(open, task, size);
                }
                break;
            case 1: {  // a copy broke off, and the file was named as if it had not
                const std::size_t size = random_size();
                write(name, ByteSpan(whole.bytes).first(size));
                count(whole, task, size);
                damaged_.insert(name);
                break;
            }
            case 2:  // two machines rendered it, and both copies came
                write(name, whole.bytes);
                write(host + "-" + name, whole.bytes);
                count(whole, task, whole.bytes.size());
                break;
            case 3:  // finished, beside an attempt of another machine
                write(name, whole.bytes);
                write(fmt::format("{}.part.{:016x}", name, random_()), ByteSpan(whole.bytes).first(random_size()));
                count(whole, task, whole.bytes.size());
                break;
            case 4:  // somebody rendered it with another seed
                write(name, file(other_, task, kRunsPerTask, true).bytes);
                ignored_.insert(name);
                break;
            case 5:  // rsync has not finished
                write(fmt::format(".{}.Xy{}", name, task), ByteSpan(whole.bytes).first(random_size()));
                break;
            default:
                write(name, whole.bytes);
                count(whole, task, whole.bytes.size());
        }
    }

    fs::path folder_;
    const Job job_ = small_job(1), other_ = small_job(2);
    std::mt19937_64 random_{42};
    std::set<SampleRange> runs_;
    std::set<std::string> damaged_, ignored_;
};

class ManyMachines : public ::testing::Test {
 protected:
    TemporaryFolder folder_;
    const Night night_{folder_ / "parts"};
    const std::string job_ = to_hex(small_job(1).id);
    Outcome merge_parts(std::vector<std::string> more) const {
        std::vector<std::string> command = {tool("latent-merge"),
                                            (folder_ / "parts").string(),
                                            "-o",
                                            (folder_ / "all.latent").string(),
                                            "--job",
                                            job_,
                                            "--json",
                                            "--quiet"};
        command.insert(command.end(), more.begin(), more.end());
        return run(command);
    }
};

TEST_F(ManyMachines, MergeTakesEveryWholeRunOnceAndListsTheRest) {
    const Outcome outcome = merge_parts({});
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    const auto report = nlohmann::json::parse(outcome.out);

    std::set<SampleRange> runs;
    const auto merged = synthetic::open_runs({folder_ / "all.latent"});
    ASSERT_TRUE(merged);
    for (const SelectedRun& run : merged->runs()) EXPECT_TRUE(runs.insert(run.header.samples).second);
    EXPECT_EQ(runs, night_.runs());
    EXPECT_EQ(merged->coverage(), night_.coverage());

    std::set<std::string> left_out, notes;
    for (const auto& item : report["left_out"]) {
        left_out.insert(fs::path(item["place"].get<std::string>()).filename().string());
        EXPECT_THAT(item["reason"].get<std::string>(), ::testing::HasSubstr("truncated or damaged"));
    }
    EXPECT_EQ(left_out, night_.damaged());
    for (const auto& note : report["notes"]) {
        const std::string text = note.get<std::string>();
        if (text.ends_with(", skipped")) notes.insert(fs::path(text.substr(0, text.find(": "))).filename().string());
    }
    EXPECT_EQ(notes, night_.ignored());
    EXPECT_GT(left_out.size(), 50u);
    EXPECT_GT(notes.size(), 50u);
}

TEST_F(ManyMachines, WhatIsRequiredIsCheckedBeforeAnythingIsWritten) {
    const Outcome outcome = merge_parts({"--require", "0:3072000"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, ::testing::HasSubstr("are required, but no part holds them; left out: "));
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"parts"});
}

}  // namespace
}  // namespace latent::merge
