// Several prints in one pass, their tone, and what is found out about their colours.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tests/convert/test_picture.h"
#include "tools/convert/inspection.h"

namespace latent::convert {
namespace {

using Exposures = PrintTest;

TEST_F(Exposures, OfOnePassAreThoseOfOneEach) {
    write_picture(folder_ / "a.exr", {.width = 700, .height = 300, .tile = 64, .zip = true});
    const testing::Outcome several =
        run_tool({at("a.exr"), "-o", at("all.png"), "-o", at("all.tif"), "--stops", "-1,0,1.5", "-s", "2", "--json"});
    ASSERT_EQ(several.status, 0) << several.err;
    const auto report = nlohmann::json::parse(several.out);
    ASSERT_EQ(report["other_exposures"].size(), 2u);
    int number = 0;
    for (const auto& [stops, name] : {std::pair{"-1", "all-1"}, {"0", "all+0"}, {"1.5", "all+1.5"}}) {
        const testing::Outcome one =
            run_tool({at("a.exr"), "-o", at("one.png"), "-o", at("one.tif"), "--stops", stops, "-s", "2", "--json", "--force"});
        ASSERT_EQ(one.status, 0) << one.err;
        for (const char* type : {".png", ".tif"})
            EXPECT_EQ(testing::read_text(folder_ / (name + std::string(type))),
                      testing::read_text(folder_ / ("one" + std::string(type))));
        const auto alone = nlohmann::json::parse(one.out);
        const auto& among = number == 0 ? report : report["other_exposures"][static_cast<std::size_t>(number - 1)];
        for (const char* key : {"sensitivity", "black", "burnt", "out_of_gamut"}) EXPECT_EQ(among[key], alone[key]) << key;
        EXPECT_EQ(among["outputs"][0], at(name + std::string(".png")));
        if (number == 0) {
            EXPECT_EQ(among["luminance"], alone["luminance"]);
        }
        ++number;
    }
}

TEST_F(Exposures, ThatCannotBeAreRefused) {
    write_picture(folder_ / "a.exr", {.width = 8, .height = 8});
    for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--stops", "1,1"},
                                                  {"--stops", "1,,2"},
                                                  {"--stops", "101"},
                                                  {"--stops", "1,nan"},
                                                  {"--stops", "1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17"},
                                                  {"-s", "1", "--key", "0.2"},
                                                  {"-s", "1", "--auto"},
                                                  {"--auto", "--key", "1"},
                                                  {"--exposure", "iso:100,time:1/125,f:8", "-s", "1"},
                                                  {"--exposure", "iso:100,time:1/125,f:8", "--auto"},
                                                  {"--exposure", "iso:100,time:1/125,f:8", "--key", "0.2"},
                                                  {"--exposure", "iso:100,time:1/125"},
                                                  {"--exposure", "iso:100,time:1/125,f:8,f:4"},
                                                  {"--exposure", "iso:100,time:1/0,f:8"},
                                                  {"--exposure", "iso:100,time:0/0,f:8"},
                                                  {"--exposure", "iso:100,time:-1,f:8"},
                                                  {"--exposure", "iso:100,time:1/125,f:0"},
                                                  {"--exposure", "100:1/125:8"},
                                                  {"--tone", "aces"},
                                                  {"--tone", "density:1,2"},
                                                  {"--tone", "none", "--contrast", "2"},
                                                  {"--contrast", "0"},
                                                  {"--black", "0.6"},
                                                  {"--show", "all"}}) {
        std::vector<std::string> arguments = {at("a.exr"), "-o", at("a.png")};
        arguments.insert(arguments.end(), wrong.begin(), wrong.end());
        const testing::Outcome outcome = run_tool(arguments);
        EXPECT_EQ(outcome.status, 2) << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(folder_ / "a.png"));
    }
}

// What saturates a sensor of ISO 100 at 1/125 s and f/8 is 78 / (0.65 100 / 125) 8^2 = 9600 cd/m^2 [ISO12232].
TEST_F(Exposures, OfCamerasPrintSaturationAsDisplayWhite) {
    bool says_unit = false;
    const auto sensitivity = [&](const std::string& exposure) {
        const testing::Outcome outcome = run_tool(
            {at("a.exr"), "-o", at("a.png"), "--exposure", exposure, "--tone", "linear", "--no-dither", "--json", "--force"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err.find("does not say how bright") == std::string::npos, says_unit) << outcome.err;
        return nlohmann::json::parse(outcome.out)["sensitivity"].get<double>();
    };
    const auto write = [&](std::optional<float> unit, float saturation) {
        says_unit = unit.has_value();
        write_picture(folder_ / "a.exr", {.width = 3, .height = 1, .white_luminance = unit},
                      [saturation](int x, int) -> std::array<float, 3> {
                          const float light = saturation * (x == 0 ? 0.5f : x == 1 ? 0.99f : 1.01f);
                          return {light * 0.3127f / 0.3290f, light, light * 0.3583f / 0.3290f};
                      });
    };
    for (const std::optional<float> unit : {std::optional<float>(), std::optional(1.0f), std::optional(683.0f)}) {
        write(unit, 9600 / unit.value_or(1));
        EXPECT_DOUBLE_EQ(sensitivity("iso:100,time:1/125,f:8"), 2.0 / 9600 * static_cast<double>(unit.value_or(1)));
        const image::Decoded png = image::decode_png(folder_ / "a.png");
        EXPECT_EQ(static_cast<int>(png.pixels[1]), 188);
        EXPECT_EQ(static_cast<int>(png.pixels[4]), 254);
        EXPECT_EQ(static_cast<int>(png.pixels[7]), 255);
    }
    const double usual = sensitivity("f:8,iso:100,time:1/125");
    EXPECT_DOUBLE_EQ(sensitivity("iso:200,time:1/125,f:8"), 2 * usual);
    EXPECT_DOUBLE_EQ(sensitivity("iso:100,time:2/125,f:8"), 2 * usual);
    EXPECT_DOUBLE_EQ(sensitivity("iso:100,time:0.032,f:8"), 4 * usual);
    EXPECT_DOUBLE_EQ(sensitivity("iso:100,time:1/125,f:4"), 4 * usual);
}

// A grey ramp: the pixel of luminance 1/sensitivity has the code of half of display white, whatever the curve.
TEST_F(Exposures, HalfOfWhiteIsAtOneOverTheSensitivityWithEveryCurve) {
    write_picture(folder_ / "a.exr", {.width = 3, .height = 1}, [](int x, int) -> std::array<float, 3> {
        const float light = 0.25f * static_cast<float>(1 << x);
        return {light * 0.3127f / 0.3290f, light, light * 0.3583f / 0.3290f};
    });
    for (const char* tone : {"film", "linear", "reinhard", "filmic", "density"}) {
        for (const char* contrast : {"1", "1.8"}) {
            const testing::Outcome outcome = run_tool(
                {at("a.exr"), "-o", at("a.png"), "-s", "2", "--tone", tone, "--contrast", contrast, "--no-dither", "--force"});
            ASSERT_EQ(outcome.status, 0) << outcome.err;
            const image::Decoded png = image::decode_png(folder_ / "a.png");
            EXPECT_EQ(static_cast<int>(png.pixels[4]), 188) << tone;
            EXPECT_LT(static_cast<int>(png.pixels[1]), 188);
            EXPECT_GT(static_cast<int>(png.pixels[7]), 188);
        }
    }
}

TEST_F(Exposures, TheKeyIsTheGreyThatTheMeanPrintsAt) {
    write_picture(folder_ / "a.exr", {.width = 64, .height = 64}, [](int, int) -> std::array<float, 3> {
        return {7 * 0.3127f / 0.3290f, 7, 7 * 0.3583f / 0.3290f};
    });
    for (const char* tone : {"film", "reinhard", "none"}) {
        const testing::Outcome outcome = run_tool(
            {at("a.exr"), "-o", at("a.exr.tif"), "--bits", "float", "--auto", "--key", "0.4", "--tone", tone, "--force", "--json"});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        const double sigma = nlohmann::json::parse(outcome.out)["sensitivity"];
        const double t = 7 * sigma;
        const double printed = tone == std::string("film") ? 1 - std::exp2(-t) : tone == std::string("none") ? t : t / (1 + t);
        EXPECT_NEAR(printed, 0.4, 0.004) << tone;  // luminances are counted in bins of 1/64 octave
    }
}

TEST_F(Exposures, AreChosenFromTheSceneWhateverItIsPrintedFor) {
    write_picture(folder_ / "a.exr", {.width = 300, .height = 200, .tile = 64});
    double chosen = 0;
    for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{{},
                                                                                      {"--auto"},
                                                                                      {"--white", "A"},
                                                                                      {"--profile", "display-p3"},
                                                                                      {"--adapt", "cat16", "--white", "3000K"},
                                                                                      {"--crop", "10,20,30,40"}}) {
        std::vector<std::string> arguments = {at("a.exr"), "-o", at("a.png"), "--force", "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const testing::Outcome outcome = run_tool(arguments);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        const auto report = nlohmann::json::parse(outcome.out);
        if (more.empty()) chosen = report["sensitivity"];
        EXPECT_EQ(report["sensitivity"], chosen) << outcome.out;
        EXPECT_EQ(report["auto_sensitivity"], chosen);
        EXPECT_NEAR(report["exposure_ev"].get<double>(), std::log2(chosen), 1e-12);
    }
    // A sensitivity that is given is kept, and the report says what would have been chosen.
    const testing::Outcome given = run_tool({at("a.exr"), "-o", at("a.png"), "-s", "64", "--force"});
    EXPECT_NE(given.out.find(fmt::format("sensitivity    64 (+6.00 EV); --auto would choose {} (", chosen)), std::string::npos)
        << given.out;
    // Stops are relative to it.
    const testing::Outcome pushed = run_tool({at("a.exr"), "-o", at("a.png"), "--stops", "2", "--force", "--json"});
    EXPECT_EQ(nlohmann::json::parse(pushed.out)["sensitivity"], 4 * chosen);
}

TEST_F(Exposures, WithoutATonePixelsKeepTheirValuesUnlessOneIsAskedFor) {
    write_picture(folder_ / "a.exr", {.width = 30, .height = 20});
    const auto sensitivity = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {at("a.exr"), "-o", at("a.out.exr"), "--tone", "none", "--force", "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return nlohmann::json::parse(run_tool(arguments).out)["sensitivity"].get<double>();
    };
    EXPECT_EQ(sensitivity({}), 1);
    EXPECT_NE(sensitivity({"--auto"}), 1);
    EXPECT_EQ(sensitivity({"--key", "0.18"}), sensitivity({"--auto"}));
}

TEST_F(Exposures, OfAPictureWithoutLightIsOneWithAWarning) {
    write_picture(folder_ / "a.exr", {.width = 4, .height = 4}, [](int, int) -> std::array<float, 3> { return {0, 0, 0}; });
    for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{{}, {"--auto"}}) {
        std::vector<std::string> arguments = {at("a.exr"), "-o", at("a.png"), "--force", "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const testing::Outcome outcome = run_tool(arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_NE(outcome.err.find("a.exr: has no light, so the print is black"), std::string::npos) << outcome.err;
        EXPECT_EQ(nlohmann::json::parse(outcome.out)["sensitivity"], 1);
    }
}

TEST_F(Exposures, BitsAreForTheOutputsThatHaveThem) {
    write_picture(folder_ / "a.exr", {.width = 40, .height = 30});
    const testing::Outcome outcome = run_tool({at("a.exr"), "-o", at("a.png"), "-o", at("a.dzi"), "--bits", "16"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("note: --bits is only for the other outputs: "), std::string::npos) << outcome.err;
    EXPECT_EQ(image::decode_png(folder_ / "a.png").format.sample, image::SampleType::kU16);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "a.dzi"));
    EXPECT_EQ(run_tool({at("a.exr"), "-o", at("b.jpg"), "-o", at("b.dzi"), "--bits", "16"}).status, 2);
}

TEST_F(Exposures, NamesMayBeAsLongAsTheSystemAllows) {
    write_picture(folder_ / "a.exr", {.width = 4, .height = 4});
    const std::string name = std::string(251, 'n') + ".png";
    for (const char* again : {"--quiet", "--force"}) EXPECT_EQ(run_tool({at("a.exr"), "-o", at(name), again}).status, 0);
    EXPECT_TRUE(std::filesystem::exists(folder_ / name));
    for (const std::string no_file : {"-", "/dev/stdout", "/dev/stdout.png"}) {
        const testing::Outcome outcome = run_tool({at("a.exr"), "-o", no_file});
        EXPECT_EQ(outcome.status, 2);
        EXPECT_NE(outcome.err.find(no_file + ": outputs are files"), std::string::npos) << outcome.err;
    }
}

TEST_F(Exposures, TheWidthOnPaperSetsTheResolution) {
    write_picture(folder_ / "a.exr", {.width = 1000, .height = 10});
    ASSERT_EQ(run_tool({at("a.exr"), "-o", at("a.png"), "--paper-width", "100"}).status, 0);
    EXPECT_EQ(image::decode_png(folder_ / "a.png").x_resolution, 10000);  // 254 per inch, in metres
    const testing::Outcome coarse = run_tool({at("a.exr"), "-o", at("a.png"), "--paper-width", "1524", "--force"});
    EXPECT_EQ(coarse.status, 0);
    EXPECT_NE(coarse.err.find("only 17 per inch"), std::string::npos) << coarse.err;
    EXPECT_NE(coarse.err.find("a picture 9000 pixels wide has 150"), std::string::npos) << coarse.err;
    for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--paper-width", "0"},
                                                  {"--paper-width", "100", "--dpi", "300"},
                                                  {"--paper-width", "0.1"},
                                                  {"--paper-width", "1000000"}}) {
        std::vector<std::string> arguments = {at("a.exr"), "-o", at("b.png")};
        arguments.insert(arguments.end(), wrong.begin(), wrong.end());
        const testing::Outcome outcome = run_tool(arguments);
        EXPECT_EQ(outcome.status, 2);
        EXPECT_NE(outcome.err.find("--paper-width"), std::string::npos) << outcome.err;
    }
}

// One pixel of each kind.
TEST_F(Exposures, AProofShowsWhatIsClipped) {
    write_picture(folder_ / "a.exr", {.width = 4, .height = 1}, [](int x, int) -> std::array<float, 3> {
        if (x == 0) return {0.95f * 100, 100, 1.09f * 100};  // burnt
        if (x == 1) return {0, 0, 0};
        if (x == 2) return {0.1f, 0.5f, 0.05f};  // a green that no display has
        return {0.95f * 0.5f, 0.5f, 1.09f * 0.5f};
    });
    const testing::Outcome outcome =
        run_tool({at("a.exr"), "-o", at("a.png"), "-s", "1", "--show", "clipped", "--no-dither", "--gamut-report"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("hue            shifted by "), std::string::npos) << outcome.out;
    const image::Decoded png = image::decode_png(folder_ / "a.png");
    const auto pixel = [&](std::size_t i) {
        return std::array{static_cast<int>(png.pixels[3 * i]), static_cast<int>(png.pixels[3 * i + 1]),
                          static_cast<int>(png.pixels[3 * i + 2])};
    };
    EXPECT_EQ(pixel(0), (std::array{255, 0, 0}));
    EXPECT_EQ(pixel(1), (std::array{0, 0, 255}));
    EXPECT_EQ(pixel(2), (std::array{255, 0, 255}));
    EXPECT_EQ(pixel(3)[0], pixel(3)[1]);
    EXPECT_EQ(pixel(3)[1], pixel(3)[2]);
    EXPECT_GT(pixel(3)[1], 100);
}

TEST_F(Exposures, TheLargestShiftOfHueIsFoundWhateverTheThreads) {
    write_picture(folder_ / "a.exr", {.width = 500, .height = 300, .tile = 32});
    ConvertOptions options;
    options.gamut_report = true;
    const Result<ConvertReport> luminance = print("a.exr", "a.png", options);
    ASSERT_TRUE(luminance) << luminance.error().message;
    EXPECT_GT(luminance->hue_shifts.largest_degrees, 20);
    options.threads = 1;
    const Result<ConvertReport> alone = print("a.exr", "b.png", options);
    EXPECT_EQ(alone->hue_shifts.largest_degrees, luminance->hue_shifts.largest_degrees);
    EXPECT_EQ(alone->hue_shifts.x, luminance->hue_shifts.x);
    EXPECT_EQ(alone->hue_shifts.y, luminance->hue_shifts.y);
    EXPECT_EQ(alone->hue_shifts.above_10_degrees, luminance->hue_shifts.above_10_degrees);
    options.gamut = "grey";
    EXPECT_LT(print("a.exr", "c.png", options)->hue_shifts.above_10_degrees, luminance->hue_shifts.above_10_degrees / 2);
}

}  // namespace
}  // namespace latent::convert
