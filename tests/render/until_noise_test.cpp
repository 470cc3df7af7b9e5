// latent-render --until-noise: as many samples as a target needs, in an ordinary file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "sampledb/read/run_set.h"
#include "tests/faults/process.h"
#include "tests/support/paths.h"

namespace latent::render {
namespace {

using latent::testing::Outcome;
using nlohmann::json;
using ::testing::HasSubstr;

// A lamp and a floor: little noise, of no rare samples.
constexpr const char* kScene =
    "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\n"
    "LookAt 0 2 -6  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 30\nWorldBegin\n"
    "AttributeBegin\nTranslate 0 3 0\nAreaLightSource \"diffuse\" \"rgb L\" [4 4 4]\nShape \"sphere\"\nAttributeEnd\n"
    "Material \"diffuse\"\nShape \"trianglemesh\" \"point3 P\" [-9 0 -9  9 0 -9  9 0 9  -9 0 9] "
    "\"integer indices\" [0 1 2  0 2 3]\n";

class UntilNoiseTest : public ::testing::Test {
 protected:
    UntilNoiseTest() { std::ofstream(folder_ / "scene.pbrt") << kScene; }
    Outcome render(const char* output, const std::vector<std::string>& more) const {
        std::vector<std::string> command{latent::testing::tool("latent-render"),
                                         (folder_ / "scene.pbrt").string(),
                                         "-o",
                                         (folder_ / output).string(),
                                         "--record",
                                         "xyz",
                                         "--run-samples",
                                         "65536"};
        command.insert(command.end(), more.begin(), more.end());
        return latent::testing::run(command);
    }
    double median_of(const char* file, const std::string& samples) const {
        const Outcome outcome = latent::testing::run({latent::testing::tool("latent-inspect"), "noise", (folder_ / file).string(),
                                                      "--size", "48", "--samples", samples, "--json"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return json::parse(outcome.out)["levels"][0]["relative"]["median"];
    }
    // First sample, end and content of every run.
    std::vector<std::string> runs_of(const char* file) const {
        sampledb::RunSetOptions options;
        options.inputs = {folder_ / file};
        const auto run_set = sampledb::RunSet::open(options);
        EXPECT_TRUE(run_set);
        std::vector<std::string> runs;
        for (const sampledb::SelectedRun& run : (*run_set)->runs())
            runs.push_back(to_string(run.coverage) + " " + to_hex(run.header.content_hash));
        return runs;
    }
    latent::testing::TemporaryFolder folder_;
};

TEST_F(UntilNoiseTest, EndsWhereTheTargetIsMetAndNoFurtherThanNeeded) {
    const Outcome outcome = render("a.latent", {"--until-noise", "1%@48", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json report = json::parse(outcome.out);
    EXPECT_EQ(report["complete"], true);
    EXPECT_EQ(report["noise"]["reached"], true);
    EXPECT_EQ(report["samples_rendered"], report["end_sample"]);  // none twice
    EXPECT_LE(report["noise"]["median"], 0.01);
    const std::uint64_t samples = report["end_sample"];
    ASSERT_GT(samples, 32u * 64 * 64) << "there is a second round";
    EXPECT_EQ(median_of("a.latent", "0:" + std::to_string(samples)), report["noise"]["median"]);
    EXPECT_GT(median_of("a.latent", "0:" + std::to_string(samples / 2)), 0.01);
    const Outcome info =
        latent::testing::run({latent::testing::tool("latent-inspect"), "info", (folder_ / "a.latent").string(), "--json"});
    EXPECT_NEAR(json::parse(info.out)["origin"]["spp"].get<double>() * 64 * 64, static_cast<double>(samples), 0.5);
    // The same target finds nothing left to do, and a smaller one goes on.
    const Outcome again = render("a.latent", {"--until-noise", "1%@48"});
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_THAT(again.out, HasSubstr("nothing left to render"));
    ASSERT_EQ(render("a.latent", {"--until-noise", "0.8%@48"}).status, 0);
    EXPECT_LE(median_of("a.latent", "0:1G"), 0.008);
}

TEST_F(UntilNoiseTest, WritesTheFileOfAnOrdinaryRender) {
    const Outcome outcome = render("a.latent", {"--until-noise", "1.5%@48", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::uint64_t samples = json::parse(outcome.out)["end_sample"];
    ASSERT_EQ(render("b.latent", {"--samples", "0:" + std::to_string(samples)}).status, 0);
    EXPECT_EQ(runs_of("a.latent"), runs_of("b.latent"));
    ASSERT_EQ(render("a.latent", {"--spp", "256"}).status, 0);  // extends it
    ASSERT_EQ(render("b.latent", {"--spp", "256"}).status, 0);
    EXPECT_EQ(runs_of("a.latent"), runs_of("b.latent"));
}

TEST_F(UntilNoiseTest, EndsAtTheLimitsAndSaysSo) {
    const Outcome limited = render("a.latent", {"--until-noise", "0.01%", "--max-spp", "20"});
    EXPECT_EQ(limited.status, 0);
    EXPECT_THAT(limited.err, HasSubstr("--max-spp: reached, and the noise is still"));
    EXPECT_THAT(limited.out, HasSubstr("samples 0:81920,"));
    const Outcome timed = render("a.latent", {"--until-noise", "0.0001%", "--max-time", "0.2"});
    EXPECT_EQ(timed.status, 75) << timed.err;
    EXPECT_THAT(timed.err, HasSubstr("run the same command again to resume"));
}

TEST_F(UntilNoiseTest, GoesOnWhereItWasStopped) {
    // No machine is that quick.
    ASSERT_EQ(render("a.latent", {"--until-noise", "0.1%@48", "--max-time", "0.05", "--checkpoint", "0.01"}).status, 75);
    const Outcome outcome = render("a.latent", {"--until-noise", "2%@48", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_LE(json::parse(outcome.out)["noise"]["median"], 0.02);
}

TEST_F(UntilNoiseTest, RefusesWhatItDoesNotUnderstand) {
    for (const char* target : {"2", "2%@", "%@1920", "2%@0", "0%", "-1%", "2%@1920x1080", "x%"})
        EXPECT_EQ(render("a.latent", {"--until-noise", target}).status, 2) << target;
    for (const char* other : {"--spp", "--shard"})
        EXPECT_EQ(render("a.latent", {"--until-noise", "2%", other, "1/2"}).status, 2) << other;
    EXPECT_EQ(render("a.latent", {"--max-spp", "20"}).status, 2);
    std::ofstream(folder_ / "scene.pbrt") << "Camera \"perspective\"\nWorldBegin\nLightSource \"point\"\n"
                                             "Translate 0 0 -9\nShape \"sphere\"\n";
    const Outcome black = render("black.latent", {"--until-noise", "2%", "--resolution", "16x16"});
    EXPECT_EQ(black.status, 0);
    EXPECT_THAT(black.err, HasSubstr("no light reaches the picture"));
}

}  // namespace
}  // namespace latent::render
