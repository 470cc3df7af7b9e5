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

TEST(Forecast, TimeFollowsFromWhatAFewRunsTake) {
    for (const double fixed : {0.0, 0.01, 3.0}) {
        for (const double each : {0.0001, 0.01, 1.0}) {
            for (const std::size_t runs : {1, 2, 30, 5000}) {
                double spent = 0, last = 0;
                const Trial trial = [&](std::size_t count) -> Result<double> {
                    spent += last = fixed + each * static_cast<double>(count);
                    return last;
                };
                const Result<double> seconds = seconds_for(runs, 2, trial);
                ASSERT_TRUE(seconds);
                EXPECT_NEAR(*seconds / (fixed + each * static_cast<double>(runs)), 1, 1e-9) << fixed << " " << each << " " << runs;
                EXPECT_LE(spent, std::max(2.0 + last, 2 * fixed + 3 * each));
            }
        }
    }
    EXPECT_FALSE(seconds_for(5, 2, [](std::size_t) -> Result<double> { return Error{}; }));
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
    EXPECT_GT(seconds_to_write(1 << 20, folder.path()), 0);
    EXPECT_EQ(seconds_to_write(0, folder.path()), 0);
    EXPECT_EQ(seconds_to_write(1 << 20, folder / "missing"), 0);
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
        std::filesystem::remove(at("a.exr"));
    }
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
