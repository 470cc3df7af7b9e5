// What a picture takes is known before it is developed.
#include "tools/develop/forecast/forecast.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/json.h"
#include "tests/faults/process.h"
#include "tests/support/synthetic.h"

namespace latent::develop {
namespace {

TEST(Forecast, CostFollowsFromWhatALittleWorkTakes) {
    for (const double fixed : {0.0, 0.01, 0.3}) {
        for (const double each : {0.0001, 0.01, 0.2}) {
            for (const double most : {1.0, 2.0, 30.0, 5000.0}) {
                double last = 0;
                const Trial trial = [&](double amount) -> Result<Tried> {
                    last = fixed + each * amount;
                    return Tried{amount, {last, 2 * last}};
                };
                const Result<LinearCost> cost = measure(2, 1, most, 2, trial);
                ASSERT_TRUE(cost);
                const Cost all = cost->of(most);
                EXPECT_NEAR(all.wall / (fixed + each * most), 1, 1e-9) << fixed << " " << each << " " << most;
                EXPECT_NEAR(all.cpu, 2 * all.wall, 1e-9 * all.wall);
                EXPECT_LE(cost->spent.wall, std::max(2.0, last) + 1e-9);
            }
        }
    }
    EXPECT_FALSE(measure(2, 1, 5, 2, [](double) -> Result<Tried> { return Error{}; }));
}

// What one thread did, that many do together; for a processor they wait as their share says, and for files as long as it did.
TEST(Forecast, OnABusyMachineTimeIsThatOfTheProcessorsShareAndOfFiles) {
    EXPECT_DOUBLE_EQ(seconds_with({10, 10, 0}, 2, 1), 5);  // nothing else runs
    EXPECT_DOUBLE_EQ(seconds_with({14, 10, 0}, 2, 1), 9);  // 4 s of waiting for files
    EXPECT_DOUBLE_EQ(seconds_with({40, 10, 30}, 2, 0.25), 20);
    EXPECT_DOUBLE_EQ(seconds_with({44, 10, 30}, 2, 0.25), 24);
    EXPECT_DOUBLE_EQ(seconds_with({12, 10, 2.5}, 2, 0.25), 20);  // less busy during the trials
    EXPECT_DOUBLE_EQ(seconds_with({14, 10, 0, 2}, 2, 0.5), 14);  // one thread writes meanwhile
    EXPECT_DOUBLE_EQ(seconds_with({14, 10, 0, 7}, 2, 0.5), 18);  // all wait for the one that writes
    const double share = processor_share(2);
    EXPECT_GT(share, 0);
    EXPECT_LE(share, 1);
}

// Costs that are linear in pixels, in bytes decoded and drawn, and in segments, of pictures from small to far too large to be
// tried, by pages of any size: the forecast is exact, and the trials do not depend on the size.
TEST(Forecast, OfAPictureOfAnySizeTakesNoLonger) {
    struct Machine {
        double setup, pixel, decode, draw;  // seconds
    };
    struct Runs {
        std::size_t count;
        double bytes;    // of each
        int page_level;  // pages are such parts of the film
    };
    constexpr int kReach = 3;
    constexpr double kSegment = 0.09e-6;  // seconds
    for (const Machine& machine :
         {Machine{0.02, 60e-9, 4e-9, 3e-9}, {0.001, 10e-9, 0.05e-9, 0.1e-9}, {0, 200e-9, 1e-9, 7e-9}, {0.003, 0, 3e-9, 0}}) {
        for (const std::uint32_t side : {100u, 512u, 3000u, 18000u, 200000u}) {
            for (const Runs& file : {Runs{40000, 1 << 17, 0}, {400, 16 << 20, 1}, {400, 16 << 20, 3}, {400, 16 << 20, 5}}) {
                const auto runs = static_cast<double>(file.count);
                double spent = 0;
                const auto pixels = [](const PixelRect& r) { return static_cast<double>(r.width() * r.height()); };
                // Share of the film that pages cover along an axis, those that cells first .. last - 1 reach.
                const auto covered = [&](std::int64_t first, std::int64_t last, int level) {
                    const double cells = std::max(1.0, std::exp2(level - file.page_level));  // of a page
                    const double pages =
                        std::ceil(static_cast<double>(last) / cells) - std::floor(static_cast<double>(first) / cells);
                    return pages * cells / std::exp2(level);
                };
                const PictureTrial trial = [&](const TrialPicture& p) -> Result<TrialOutcome> {
                    const double bytes = file.bytes * static_cast<double>(p.runs);
                    const FilmGrid grid(p.width, p.height, kReach);
                    const PixelRect cells = grid.cells_reaching(p.crop);
                    const double decoded =
                        bytes * covered(cells.x0, cells.x1, grid.level()) * covered(cells.y0, cells.y1, grid.level());
                    const double drawn = bytes * pixels(cells) / std::exp2(2 * grid.level());
                    const double segments = static_cast<double>(p.runs) * pixels(cells);
                    const double seconds = machine.setup + machine.pixel * pixels(p.crop) + machine.decode * decoded +
                                           machine.draw * drawn + kSegment * segments;
                    spent += seconds;
                    return TrialOutcome{
                        {seconds, seconds, 0}, static_cast<std::uint64_t>(decoded), static_cast<std::uint64_t>(segments)};
                };
                const PixelRect whole{0, 0, side, side};
                const double decoded = (side > 10000 ? 1.5 : 1) * runs * file.bytes;  // some twice, if memory is small
                const double segments = runs * std::exp2(2 * FilmGrid(side, side, kReach).level());
                const Result<TrialOutcome> expected =
                    extrapolate({side, side, whole, file.count, kReach}, decoded, segments, trial);
                ASSERT_TRUE(expected);
                const double truth = machine.setup + machine.pixel * pixels(whole) + machine.decode * decoded +
                                     machine.draw * runs * file.bytes + kSegment * segments;
                EXPECT_NEAR(expected->cost.cpu / truth, 1, 0.03) << side << " " << machine.decode << " " << file.page_level;
                EXPECT_LE(spent, 1.9 + 8 * machine.setup) << side << " " << machine.decode << " " << file.page_level;
            }
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
    EXPECT_GE(seconds_to_reach_disk(1 << 20, folder.path()), 0);
    EXPECT_EQ(seconds_to_reach_disk(0, folder.path()), 0);
    EXPECT_EQ(seconds_to_reach_disk(1 << 20, folder / "missing"), 0);
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
    for (const Options& options : {Options{"--size", "96", "--mipmap", "--halves"}, Options{"--size", "96", "--fraction", "0.3"},
                                   Options{"--size", "96", "--crop", "10,20,30,40"}}) {
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
        EXPECT_EQ(forecast["crop"], report["crop"]);
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

// Trials are smaller, and their sides are rounded: at 395 x 166 they do not have the shape of this film.
TEST(Forecast, OfAFilmOfAnyShapeIsMade) {
    const testing::TemporaryFolder folder;
    sampledb::Job job = synthetic::make_short_job();
    job.aspect_width = 239, job.aspect_height = 100;
    const std::string path = (folder / "wide.latent").string();
    synthetic::write_file(path, synthetic::make_file(job, synthetic::runs_between({0, 4096, 8192})).bytes);
    for (const char* size : {"398", "403"}) {
        const testing::Outcome outcome =
            testing::run({testing::tool("latent-develop"), path, "-o", (folder / "a.exr").string(), "--size", size, "--dry-run"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
    }
}

}  // namespace
}  // namespace latent::develop
