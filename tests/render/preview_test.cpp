// latent-render --preview: a picture soon, and nothing else.
#include "render/preview/preview.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/faults/process.h"
#include "tests/support/paths.h"

namespace latent::render {
namespace {

using latent::testing::Outcome;
using ::testing::HasSubstr;

class PreviewTest : public ::testing::Test {
 protected:
    Outcome render(const std::vector<std::string>& more) {
        std::vector<std::string> command{latent::testing::tool("latent-render"), latent::testing::in_tree("scenes/cornell.pbrt"),
                                         "-o", (folder_ / "p.latent").string()};
        command.insert(command.end(), more.begin(), more.end());
        return latent::testing::run(command);
    }
    // Width and height in the header of a PNG.
    std::pair<unsigned, unsigned> png_size(const char* name) {
        std::ifstream file(folder_ / name, std::ios::binary);
        unsigned char head[24] = {};
        file.read(reinterpret_cast<char*>(head), sizeof head);
        EXPECT_EQ(std::string(reinterpret_cast<char*>(head), 8), "\x89PNG\r\n\x1a\n");
        const auto number = [&](int at) {
            return unsigned{head[at]} << 24 | head[at + 1] << 16 | head[at + 2] << 8 | head[at + 3];
        };
        return {number(16), number(20)};
    }
    latent::testing::TemporaryFolder folder_;
};

TEST_F(PreviewTest, APictureIsAllThatItLeavesAndTheNextOneTakesItsPlace) {
    for (int again = 0; again < 2; ++again) {
        const Outcome outcome = render({"--resolution", "60x60", "--spp", "1", "--preview", "60"});  // done long before
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("p.preview.png: 60 x 60 pixels, 1 sample per pixel, denoised"));
        EXPECT_THAT(outcome.out, HasSubstr("scene: 24 triangles, 1 quadric\n3600 samples would take"));
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"p.preview.png"});
        EXPECT_EQ(png_size("p.preview.png"), (std::pair{60u, 60u}));
    }
}

TEST_F(PreviewTest, ABlackPictureIsSaidToBeBlackWithItsForecast) {
    const std::filesystem::path scene = folder_ / "black.pbrt";
    std::ofstream(scene)
        << "Film \"rgb\" \"integer xresolution\" 20 \"integer yresolution\" 20\nCamera \"perspective\"\nWorldBegin\n"
           "LightSource \"point\"\nTranslate 0 0 -9\nShape \"sphere\"\n";
    const Outcome outcome = latent::testing::run({latent::testing::tool("latent-render"), scene.string(), "-o",
                                                  (folder_ / "p.latent").string(), "--spp", "4", "--preview", "60"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out,
                HasSubstr("p.preview.png: 20 x 20 pixels, 4 samples per pixel, denoised, all black: check where the camera looks"));
    EXPECT_THAT(outcome.out, HasSubstr("1600 samples would take"));
    EXPECT_EQ(png_size("p.preview.png"), (std::pair{20u, 20u}));
}

// Noise takes most of the bytes of a picture.
TEST_F(PreviewTest, HasNoNoiseUnlessItIsToStay) {
    const auto bytes = [&](std::vector<std::string> options) {
        options.insert(options.end(), {"--resolution", "100x100", "--spp", "4", "--preview", "60", "--json"});
        const Outcome outcome = render(options);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(nlohmann::json::parse(outcome.out)["preview"]["denoised"], options[0] != "--no-denoise");
        return static_cast<double>(std::filesystem::file_size(folder_ / "p.preview.png"));
    };
    EXPECT_LT(bytes({"--quiet"}), 0.8 * bytes({"--no-denoise"}));
    EXPECT_EQ(render({"--no-denoise", "--dry-run"}).status, 2);
}

TEST_F(PreviewTest, AScenePictureIsSeenBeforeTheTimeBegins) {
    const std::filesystem::path scene = folder_ / "slide.pbrt";
    std::ofstream(scene)
        << "Film \"rgb\" \"integer xresolution\" 30 \"integer yresolution\" 20\nCamera \"perspective\"\nWorldBegin\n"
           "LightSource \"infinite\"\nTexture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \""
        << latent::testing::in_tree("scenes/slide.png")
        << "\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nTranslate 0 0 2\nShape \"sphere\"\n";
    const Outcome outcome = latent::testing::run({latent::testing::tool("latent-render"), scene.string(), "-o",
                                                  (folder_ / "p.latent").string(), "--spp", "4", "--preview", "60"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("p.preview.png: 30 x 20 pixels, 4 samples per pixel"));
    std::filesystem::remove(scene);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"p.preview.png"});
}

TEST_F(PreviewTest, ItsSizeIsThatOfTheJobUnlessTimeIsShort) {
    ASSERT_EQ(render({"--resolution", "40x40", "--spp", "8", "--preview", "60"}).status, 0);
    EXPECT_EQ(png_size("p.preview.png"), (std::pair{40u, 40u}));
    // An attempt that was stopped before its end is developed, too.
    const Outcome stopped = render({"--resolution", "16000x16000", "--preview", "0.000001", "--json"});
    ASSERT_EQ(stopped.status, 0) << stopped.err;
    const auto report = nlohmann::json::parse(stopped.out);
    EXPECT_GE(report["preview"]["samples_per_pixel"], 1);
    EXPECT_GE(report["preview"]["width"], 160);
    EXPECT_LE(report["preview"]["width"], 1024);
    EXPECT_EQ(png_size("p.preview.png").first, report["preview"]["width"]);
    EXPECT_LT(report["measured_samples"], report["samples"]);
    EXPECT_EQ(report["scene"]["triangles"], 24);
    EXPECT_EQ(report["scene"]["with_instances"],
              (nlohmann::json{{"triangles", 24}, {"patches", 0}, {"curve_segments", 0}, {"quadrics", 1}}));
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"p.preview.png"});
}

TEST_F(PreviewTest, WhatIsRenderedAlreadyStays) {
    ASSERT_EQ(render({"--resolution", "32x32", "--spp", "4"}).status, 0);
    const Outcome outcome = render({"--resolution", "32x32", "--spp", "4", "--preview", "60"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("all 4096 samples are already committed"));
    EXPECT_EQ(folder_.names(), (std::vector<std::string>{"p.latent", "p.preview.png"}));
    EXPECT_EQ(render({"--preview", "1", "--dry-run"}).status, 2);
    // Samples of another job do not keep anyone from a look.
    const std::string samples = latent::testing::read_text(folder_ / "p.latent");
    for (const std::vector<std::string>& look : {std::vector<std::string>{"--preview", "60"}, {"--dry-run"}}) {
        std::vector<std::string> options = {"--resolution", "32x32", "--spp", "4", "--seed", "9"};
        options.insert(options.end(), look.begin(), look.end());
        const Outcome other = render(options);
        EXPECT_EQ(other.status, 0) << other.err;
        EXPECT_THAT(other.err, HasSubstr("p.latent: holds the samples of another job, and stays as it is"));
    }
    EXPECT_EQ(latent::testing::read_text(folder_ / "p.latent"), samples);
}

// Its samples are in a hidden folder, which is gone with them.
TEST_F(PreviewTest, AFolderThatTakesNoSamplesIsNamedWithWhatToDo) {
    const auto preview = [](const std::filesystem::path& folder, const std::string& resolution) {
        return latent::testing::run({latent::testing::tool("latent-render"), latent::testing::in_tree("scenes/cornell.pbrt"), "-o",
                                     (folder / "p.latent").string(), "--resolution", resolution, "--preview", "60"});
    };
    const Outcome refused = preview("/proc", "60x60");
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.err,
                ::testing::MatchesRegex("latent-render: /proc: cannot write: [^\n]*; choose another folder with -o\n"));

    const latent::testing::SmallDisk disk(1 << 20);
    if (!disk.mounted()) GTEST_SKIP() << "no right to mount a small disk";
    const Outcome full = preview(disk / "", "1000x1000");
    EXPECT_EQ(full.status, 1);
    EXPECT_EQ(full.err, "latent-render: " + (disk / "x").parent_path().string() +
                            ": no space left for the samples of the preview; free some, or choose another folder with -o\n");
    EXPECT_THAT(disk.names(), ::testing::IsEmpty());
}

TEST_F(PreviewTest, NeedsNoNameForAFileThatItDoesNotWrite) {
    const std::string scene = latent::testing::in_tree("scenes/cornell.pbrt"), program = latent::testing::tool("latent-render");
    const auto in_folder = [&](const std::string& options) {
        return latent::testing::run(
            {"/bin/sh", "-c",
             "cd '" + folder_.path().string() + "' && '" + program + "' '" + scene + "' --resolution 32x32 " + options});
    };
    EXPECT_THAT(in_folder("--dry-run --max-time 0.1").out, HasSubstr("16384 samples would take"));
    EXPECT_EQ(in_folder("--preview 60").status, 0);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"cornell.preview.png"});
    const Outcome nameless = in_folder("");
    EXPECT_EQ(nameless.status, 2);
    EXPECT_THAT(nameless.err, HasSubstr("--output is required"));
}

}  // namespace
}  // namespace latent::render
