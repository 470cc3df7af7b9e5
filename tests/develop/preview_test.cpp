// Previews: pictures of some of the runs, spread evenly, nested, and as many as a budget of time allows.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/json.h"
#include "tests/develop/developed.h"
#include "tests/faults/process.h"
#include "tests/support/opened_runs.h"
#include "tests/support/synthetic.h"
#include "tools/develop/arguments.h"
#include "tools/develop/engine/subset.h"
#include "tools/develop/forecast/estimate.h"

namespace latent::develop {
namespace {

using namespace latent::testing;
using sampledb::Coverage;
using sampledb::SampleRange;

TEST(Budget, AsManyRunsAsFitByTheTimeThatAFewTake) {
    for (const double fixed : {0.0, 0.05, 0.4}) {
        for (const double each : {0.0001, 0.01, 0.3}) {
            for (const double budget : {2.0, 10.0, 60.0}) {
                double spent = 0;
                const Trial trial = [&](double amount) -> Result<Tried> {
                    const double runs = std::floor(amount), seconds = fixed + each * runs;
                    spent += seconds;
                    return Tried{runs, {seconds, 0}};
                };
                const Result<std::size_t> count = runs_within(budget, 100000, trial);
                ASSERT_TRUE(count);
                const double total = spent + fixed + each * static_cast<double>(*count);
                EXPECT_LE(total, std::max(budget, 2 * (fixed + each))) << fixed << " " << each << " " << *count;
                if (budget < 25 * (fixed + each)) continue;       // too little time to find out
                const double possible = (budget - fixed) / each;  // if nothing had to be tried
                EXPECT_GE(static_cast<double>(*count), std::min(100000.0, possible) * 0.4) << fixed << " " << each << " " << budget;
            }
        }
    }
}

TEST(Budget, OneRunIsDevelopedHoweverLongItTakes) {
    const Trial slow = [](double runs) -> Result<Tried> { return Tried{runs, {100, 0}}; };
    EXPECT_EQ(*runs_within(1, 50, slow), 1u);
    EXPECT_EQ(*runs_within(-3, 50, slow), 1u);
    EXPECT_EQ(*runs_within(1, 1, [](double) -> Result<Tried> { return Error{}; }), 1u);  // nothing to try
    EXPECT_FALSE(runs_within(1, 50, [](double) -> Result<Tried> { return Error{}; }));
}

TEST(Fraction, IsANumberAboveNoneAndUpToAll) {
    EXPECT_EQ(*parse_fraction("0.25"), 0.25);
    EXPECT_EQ(*parse_fraction("1"), 1);
    for (const char* wrong : {"0", "-1", "1.1", "x", ""}) EXPECT_EQ(parse_fraction(wrong).error().code, ErrorCode::kUsage) << wrong;
}

class Preview : public ::testing::Test {
 protected:
    static constexpr std::uint64_t kRuns = 200;
    TemporaryFolder folder_;

    Preview() {
        sampledb::Job job = synthetic::make_job(sampledb::RecordKind::kXyz);
        job.run_samples = 1024;
        std::vector<Coverage> runs;
        for (std::uint64_t i = 0; i < kRuns; ++i) runs.emplace_back(SampleRange{i * 1024, (i + 1) * 1024});
        synthetic::write_file(folder_ / "a.latent", synthetic::make_file(job, std::span(runs).first(77)).bytes);
        synthetic::write_file(folder_ / "b.latent", synthetic::make_file(job, std::span(runs).subspan(77)).bytes);
    }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    nlohmann::json develop(const std::string& picture, std::vector<std::string> more, int status = 0) const {
        std::vector<std::string> command = {tool("latent-develop"), path("b.latent"), path("a.latent"), "-o",
                                            path(picture),          "--json"};
        command.insert(command.end(), more.begin(), more.end());
        const Outcome outcome = run(command);
        EXPECT_EQ(outcome.status, status) << outcome.err;
        return outcome.status == 0 ? nlohmann::json::parse(outcome.out) : nlohmann::json();
    }
};

TEST_F(Preview, MoreRunsHoldFewerOnesAndAreSpreadEvenly) {
    const auto all = synthetic::open_runs({folder_ / "a.latent", folder_ / "b.latent"});
    const auto same = synthetic::open_runs({folder_ / "b.latent", folder_ / "a.latent"});
    ASSERT_TRUE(all && same);
    const std::vector<std::uint32_t> order = shuffled_runs(*all);
    EXPECT_EQ(order, shuffled_runs(*same));  // whatever the order of files
    EXPECT_EQ(std::set(order.begin(), order.end()).size(), kRuns);
    EXPECT_EQ(count_for(*all, order, 0.001), 1u);
    EXPECT_EQ(count_for(*all, order, 0.1), kRuns / 10);
    EXPECT_EQ(count_for(*all, order, 1), kRuns);
    // Of the first half of the order, a quarter to three quarters lie in the first half of the samples; by chance, 1 in 10^12
    // fails.
    const auto low = std::count_if(order.begin(), order.begin() + kRuns / 2, [](std::uint32_t run) { return run < kRuns / 2; });
    EXPECT_GT(low, kRuns / 8);
    EXPECT_LT(low, 3 * kRuns / 8);
}

TEST_F(Preview, IsThePictureOfTheRunsThatItNames) {
    const nlohmann::json report = develop("tenth.exr", {"--fraction", "0.1", "--size", "32"});
    EXPECT_EQ(report["runs"], kRuns / 10);
    EXPECT_EQ(report["available_samples"], kRuns * 1024);
    // The same runs in a file of their own.
    sampledb::Job job = synthetic::make_job(sampledb::RecordKind::kXyz);
    job.run_samples = 1024;
    std::vector<Coverage> runs;
    std::uint64_t samples = 0;
    for (const auto& range : report["samples"]) {
        for (std::uint64_t at = range[0]; at < range[1]; at += 1024) runs.emplace_back(SampleRange{at, at + 1024});
    }
    for (const Coverage& run : runs) samples += run.size();
    EXPECT_EQ(samples, kRuns / 10 * 1024);
    synthetic::write_file(folder_ / "those.latent", synthetic::make_file(job, runs).bytes);
    ASSERT_EQ(run({tool("latent-develop"), path("those.latent"), "-o", path("those.exr"), "--size", "32"}).status, 0);
    EXPECT_TRUE(pixels_of_exr(folder_ / "tenth.exr") == pixels_of_exr(folder_ / "those.exr"));
}

TEST_F(Preview, HasASampleForEachPixelAndIsNeverLargerThanTheWhole) {
    const nlohmann::json whole = develop("whole.exr", {});
    const auto pixels = [](const nlohmann::json& report) { return report["width"].get<double>() * report["height"].get<double>(); };
    EXPECT_EQ(whole["available_samples"], kRuns * 1024);
    for (const char* fraction : {"0.005", "0.02", "0.5"}) {
        const nlohmann::json part = develop(std::string(fraction) + ".exr", {"--fraction", fraction});
        EXPECT_LE(pixels(part), pixels(whole));
        EXPECT_LE(pixels(part), static_cast<double>(part["runs"].get<std::uint64_t>() * 1024));
    }
}

TEST_F(Preview, ABudgetThatIsLargeEnoughGivesTheWholePicture) {
    EXPECT_EQ(develop("all.exr", {"--budget", "10m", "--size", "16"})["runs"], kRuns);
    develop("whole.exr", {"--size", "16"});
    EXPECT_TRUE(read_text(folder_ / "all.exr") == read_text(folder_ / "whole.exr"));
    EXPECT_EQ(develop("little.exr", {"--budget", "0.000001", "--size", "16"})["runs"], 1);
    develop("both.exr", {"--budget", "1s", "--fraction", "0.5"}, 2);
    develop("all.exr", {"--budget", "1s"}, 1);  // exists
}

}  // namespace
}  // namespace latent::develop
