// latent-print against latent-develop and latent-convert in a row.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/print/samples.h"

namespace latent::testing {
namespace {

class Print : public Samples {
 protected:
    static Outcome print(const std::vector<std::string>& options) { return use("latent-print", "a.latent", options); }
    static std::vector<std::string> names() { return folder_->names(); }
};

TEST_F(Print, HasTheBytesOfTheTwoTools) {
    const std::string recipe = write("r.json", R"({"latent-recipe": 1,
        "develop": {"size": 120, "mipmap": true, "compression": "zip", "crop": "0,0,110,80", "halves": true},
        "convert": {"level": 1, "crop": "2,2,50,38", "compression": 6, "bits": 16, "glare": "f:16"}})");
    struct Choice {
        std::vector<std::string> develop, convert;
    };
    const Choice choices[] = {
        {{}, {}},
        {{"--size", "150", "--light", "lamp=2.5,6500K", "--light", "sky=0.2", "--denoise"}, {"--stops", "1", "--white", "A"}},
        {{"--size", "90", "--crop", "10,20,70,50", "--observer", "canon_eos_5d"}, {"--sensitivity", "2", "--no-dither"}},
        {{"--size", "75", "--spectral-bins", "10", "--fraction", "0.5"}, {"--key", "0.3"}},
        {{"--recipe", recipe}, {"--recipe", recipe}},
    };
    for (const Choice& choice : choices) {
        ASSERT_NO_FATAL_FAILURE(make("latent-develop", "a.latent", with(choice.develop, {"-o", path("a.exr")})));
        const std::vector<std::string> outputs{"-o", path("p.tif"), "-o", path("p.exr"), "-o", path("p.dzi")};
        ASSERT_NO_FATAL_FAILURE(make("latent-convert", "a.exr", with(choice.convert, outputs)));
        std::vector<std::string> bytes;
        const char* const kFiles[] = {"p.tif", "p.exr", "p.dzi", "p.html", "p_files/0/0_0.jpg", "p_files/6/0_0.jpg"};
        for (const char* file : kFiles) bytes.push_back(bytes_of(file));
        const bool same_recipe = choice.develop == choice.convert;
        const std::vector<std::string> both = same_recipe ? choice.develop : with(choice.develop, choice.convert);
        for (const char* threads : {"1", "2"}) {
            const Outcome printed = print(with(with(both, outputs), {"--threads", threads, "--memory", "128M"}));
            ASSERT_EQ(printed.status, 0) << printed.err;
            for (std::size_t i = 0; i < bytes.size(); ++i) EXPECT_TRUE(bytes[i] == bytes_of(kFiles[i])) << kFiles[i];
        }
    }
}

TEST_F(Print, LeavesNothingButTheOutputs) {
    std::vector<std::string> expected = with(names(), {"only.png"});
    std::ranges::sort(expected);
    ASSERT_EQ(print({"--size", "60", "-o", path("only.png")}).status, 0);
    EXPECT_EQ(names(), expected);
    std::filesystem::remove(path("only.png"));
}

// An hour of developing must not end in a misspelt name.
TEST_F(Print, WhatIsWrongWithThePrintIsSaidBeforeSamplesAreRead) {
    write("taken.png", "");
    write("taken+1.png", "");
    const std::vector<std::string> before = names();
    const auto refused = [&](const std::vector<std::string>& options, int status, const std::string& why) {
        const Outcome outcome = run(with({tool("latent-print"), path("nothing.latent")}, options));
        EXPECT_EQ(outcome.status, status);
        EXPECT_EQ(outcome.err, "latent-print: " + why + "\n");
    };
    refused({"-o", path("x.gif")}, 2, path("x.gif") + ": the name must end in .png, .tif, .jpg, .exr or .dzi");
    refused({"-o", path("taken.png")}, 1, path("taken.png") + ": already exists; use --force to replace it");
    refused({"-o", path("taken.png"), "--stops", "0,1"}, 1, path("taken+1.png") + ": already exists; use --force to replace it");
    refused({"-o", path("x.png"), "--tone", "filmik"}, 2,
            "--tone: 'filmik' is not a tone curve (choose film, linear, reinhard, filmic, density, "
            "density:GAMMA,TOE,SHOULDER or none)");
    refused({"-o", path("x.png"), "--frames", "3"}, 2,
            "--frames: a print shows one picture; develop the frames with latent-develop, then print each");
    refused({"-o", path("x.png")}, 1, path("nothing.latent") + ": no such file");
    EXPECT_EQ(names(), before);
}

TEST_F(Print, ADiskThatFailsOrIsFullEndsInOneLineAndLeavesNothing) {
    const std::vector<std::string> before = names();
    const std::vector<std::string> command{tool("latent-print"), path("a.latent"), "--quiet", "-o", path("f.png"), "-o",
                                           path("f.tif")};
    int met = 0;
    for (const std::string fault : {"ENOSPC", "EIO"}) {
        for (int n = 1; n <= 40; n += 1 + n / 3) {
            const std::string rule = "write:" + std::to_string(n) + ":" + fault;
            const FaultOutcome outcome = run_with_fault(command, {rule, folder_->path().string()});
            SCOPED_TRACE(rule + ": " + outcome.err);
            EXPECT_EQ(outcome.status, outcome.happened ? 1 : 0);
            EXPECT_EQ(std::ranges::count(outcome.err, '\n'), outcome.happened ? 1 : 0);
            met += outcome.happened ? 1 : 0;
            for (const char* name : {"f.png", "f.tif"}) EXPECT_EQ(std::filesystem::remove(path(name)), !outcome.happened) << name;
            EXPECT_EQ(names(), before);
        }
    }
    EXPECT_GT(met, 4);
}

TEST_F(Print, ReportsOnBothStepsAsOneObject) {
    const Outcome printed = print({"--size", "60", "-o", path("j.png"), "--json"});
    ASSERT_EQ(printed.status, 0) << printed.err;
    const auto report = nlohmann::json::parse(printed.out);
    EXPECT_EQ(report["develop"]["width"], 60);
    EXPECT_EQ(report["convert"]["outputs"][0], path("j.png"));
}

}  // namespace
}  // namespace latent::testing
