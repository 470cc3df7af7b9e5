// What a picture takes is known before it is developed.
#include "tools/develop/forecast.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/json.h"
#include "tests/faults/process.h"
#include "tests/support/synthetic.h"

namespace latent::develop {
namespace {

TEST(Forecast, CostFollowsFromWhatAFewRunsTake) {
    for (const double fixed : {0.0, 0.01, 0.3}) {
        for (const double each : {0.0001, 0.01, 0.2}) {
            for (const std::size_t runs : {1, 2, 30, 5000}) {
                double last = 0;
                const Trial trial = [&](std::size_t count) -> Result<Cost> {
                    last = fixed + each * static_cast<double>(count);
                    return Cost{last, 2 * last};
                };
                const Result<RunCost> cost = measure_runs(2, runs, trial);
                ASSERT_TRUE(cost);
                const Cost all = cost->of(static_cast<double>(runs));
                EXPECT_NEAR(all.wall / (fixed + each * static_cast<double>(runs)), 1, 1e-9) << fixed << " " << each << " " << runs;
                EXPECT_NEAR(all.cpu, 2 * all.wall, 1e-9 * all.wall);
                EXPECT_LE(cost->spent.wall, std::max(2.0, last) + 1e-9);
            }
        }
    }
    EXPECT_FALSE(measure_runs(2, 5, [](std::size_t) -> Result<Cost> { return Error{}; }));
}

// Costs that are linear in pixels and runs, of pictures from small to far too large to be tried: the forecast is exact, and the
// trials do not depend on the size.
TEST(Forecast, OfAPictureOfAnySizeTakesNoLonger) {
    struct Machine {
        double setup, pixel, run;  // seconds
    };
    constexpr std::size_t kRuns = 400;
    constexpr std::int64_t kPages = 16;  // of a run, one above the other on the film
    for (const Machine& machine : {Machine{0.02, 60e-9, 0.25}, {0.001, 10e-9, 0.01}, {0, 200e-9, 0.5}}) {
        for (const std::uint32_t side : {100u, 512u, 3000u, 18000u, 200000u}) {
            double spent = 0;
            const auto pixels = [](const PixelRect& r) { return static_cast<double>(r.width() * r.height()); };
            const PictureTrial trial = [&](const TrialPicture& p) -> Result<TrialOutcome> {
                const std::int64_t first = p.crop.y0 * kPages / p.height, last = (p.crop.y1 * kPages - 1) / p.height;
                const auto pages = static_cast<double>(last - first + 1);
                const double seconds =
                    machine.setup + machine.pixel * pixels(p.crop) + machine.run * static_cast<double>(p.runs) * pages / kPages;
                spent += seconds;
                return TrialOutcome{{seconds, seconds}, static_cast<std::uint64_t>(pages) * 1000 * p.runs, 0};
            };
            const PixelRect whole{0, 0, side, side};
            const Result<TrialOutcome> expected = extrapolate({side, side, whole, kRuns}, 1.5, trial);
            ASSERT_TRUE(expected);
            const double truth = machine.setup + machine.pixel * pixels(whole) + 1.5 * machine.run * kRuns;
            // Where there is time for one run only, all that it takes counts as its own.
            const double small = machine.setup + machine.pixel * (1 << 18), one = small + machine.run;
            const double excess = 3 * one + machine.run > 0.9 ? small / machine.run : 0;
            EXPECT_GE(expected->cost.cpu / truth, 1 - 0.01) << side << " " << machine.run;
            EXPECT_LE(expected->cost.cpu / truth, 1 + 0.01 + excess) << side << " " << machine.run;
            EXPECT_LE(spent, 0.9 + machine.run + 16 * 1.1 * (1 << 20) * machine.pixel + machine.setup) << side;
        }
    }
}

TEST(Forecast, WhatDoesNotFitOnTheDiskIsNotBegun) {
    const testing::TemporaryFolder folder;
    const std::filesystem::path output = folder / "a.exr";
    EXPECT_TRUE(check_space(output, false, 1 << 20));
    const Status s = check_space(output, false, std::uint64_t{1} << 62);
    ASSERT_FALSE(s);
    EXPECT_EQ(s.error().code, ErrorCode::kNoSpace);
    EXPECT_NE(s.error().message.find("--ignore-space"), std::string::npos) << s.error().message;
}

// A picture takes as long as its file to reach the disk, too.
TEST(Forecast, OfWritingTakesTimeAndLeavesNothing) {
    const testing::TemporaryFolder folder;
    EXPECT_GT(cost_to_write(1 << 20, folder.path()).wall, 0);
    EXPECT_GT(cost_to_write(1 << 20, folder.path()).cpu, 0);
    EXPECT_EQ(cost_to_write(0, folder.path()).wall, 0);
    EXPECT_EQ(cost_to_write(1 << 20, folder / "missing").wall, 0);
    EXPECT_TRUE(folder.names().empty());
}

TEST(Forecast, OfTheToolIsThatOfItsFileAndWritesNone) {
    const testing::TemporaryFolder folder;
    const auto at = [&](const char* name) { return (folder / name).string(); };
    const std::vector<sampledb::Coverage> runs = synthetic::runs_between({0, 4096, 8192, 12288});
    synthetic::write_file(folder / "a.latent", synthetic::make_file(synthetic::make_short_job(), runs).bytes);
    const auto run = [&](std::vector<std::string> options) {
        options.insert(options.begin(), {testing::tool("latent-develop"), at("a.latent"), "-o", at("a.exr")});
        return testing::run(options);
    };
    using Options = std::vector<std::string>;
    for (const Options& options : {Options{"--size", "96", "--mipmap", "--halves"}, Options{"--size", "96", "--fraction", "0.3"}}) {
        std::vector<std::string> dry = options;
        dry.insert(dry.end(), {"--dry-run", "--json"});
        const testing::Outcome outcome = run(dry);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(at("a.exr")));
        const auto forecast = nlohmann::json::parse(outcome.out);
        std::vector<std::string> wet = options;
        wet.insert(wet.end(), {"--force", "--json"});
        const auto report = nlohmann::json::parse(run(wet).out);
        EXPECT_EQ(forecast["width"], report["width"]);
        EXPECT_EQ(forecast["height"], report["height"]);
        const auto size = static_cast<double>(std::filesystem::file_size(at("a.exr")));
        EXPECT_NEAR(forecast["expected_bytes"].get<double>() / size, 1, 0.2);
        EXPECT_TRUE(forecast["fits"]);
        EXPECT_GT(forecast["expected_seconds"], 0);
        EXPECT_GT(forecast["expected_cpu_seconds"], 0);
        std::filesystem::remove(at("a.exr"));
    }
    EXPECT_EQ(testing::run({testing::tool("latent-develop"), at("a.latent"), "--dry-run"}).status, 0);
    EXPECT_EQ(testing::run({testing::tool("latent-develop"), at("a.latent")}).status, 2);
    const testing::Outcome text = run({"--dry-run"});
    EXPECT_NE(text.out.find(" free"), std::string::npos) << text.out;
    EXPECT_EQ(run({"--size", "4M", "--dry-run", "--crop", "0,0,8,8"}).status, 0);
    const testing::Outcome huge = run({"--size", "4M"});
    EXPECT_EQ(huge.status, 1);
    EXPECT_NE(huge.err.find("are free in"), std::string::npos) << huge.err;
    // Nobody waits for what will not be begun.
    const testing::Outcome never = run({"--size", "4M", "--dry-run"}), json = run({"--size", "4M", "--dry-run", "--json"});
    EXPECT_EQ(never.status, 0) << never.err;
    EXPECT_NE(never.out.find(": not enough"), std::string::npos) << never.out;
    EXPECT_EQ(never.out.find("about"), std::string::npos) << never.out;
    const auto forecast = nlohmann::json::parse(json.out);
    EXPECT_FALSE(forecast["fits"]);
    EXPECT_FALSE(forecast.contains("expected_seconds"));
    EXPECT_GT(forecast["expected_bytes"], forecast["free_bytes"]);
}

}  // namespace
}  // namespace latent::develop
