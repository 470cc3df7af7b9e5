// Exposures of films, developed and printed.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class FilmPrint : public PrintTest {
 protected:
    // Exposures of a film of 400, around those of its grey card.
    static std::array<float, 3> exposures(int x, int y) {
        std::array<float, 3> light = colourful(x, y);
        for (float& v : light) v *= 0.025F / 0.18F;
        return light;
    }
    void write(const std::string& name, const std::string& film, const std::string& index = "400",
               const Light& light = exposures) const {
        write_picture(
            folder_ / name,
            {.chromaticities = std::nullopt, .texts = {{"latentFilm", film}, {"latentExposureIndex", index}, {"latentPush", "0"}}},
            light);
    }
    static ConvertOptions on(const std::string& paper) {
        ConvertOptions options;
        options.darkroom.paper = paper;
        return options;
    }
    Bytes pixels(const std::string& output, const ConvertOptions& options, const std::string& input = "film.exr") const {
        const Result<ConvertReport> report = print(input, output, options);
        EXPECT_TRUE(report) << (report ? "" : report.error().message);
        return report ? image::decode_png(folder_ / output).pixels : Bytes{};
    }
    void SetUp() override { write("film.exr", "portra-400"); }
};

TEST_F(FilmPrint, IsTheSameForAnyThreadsMemoryAndCropWithItsGrain) {
    for (const bool grain : {false, true}) {
        ConvertOptions options = on("endura");
        options.darkroom.grain = grain;
        options.dither = color::Dither::kNone;
        options.threads = 1;
        const Bytes whole = pixels(grain ? "a.png" : "b.png", options);
        options.threads = 3;
        options.memory = 32 << 20;  // three threads with grain need 27 MB
        EXPECT_EQ(pixels(grain ? "c.png" : "d.png", options), whole);
        options.crop = image::Rect{33, 21, 133, 71};
        const Bytes crop = pixels(grain ? "e.png" : "f.png", options);
        for (std::size_t y = 0; y < 50; ++y) {
            for (std::size_t i = 0; i < 300; ++i) ASSERT_EQ(crop[y * 300 + i], whole[(y + 21) * 900 + 99 + i]);
        }
    }
}

TEST_F(FilmPrint, AGreyCardIsNeutralAt18PercentOfTheLightAndAStopMoreIsTwiceTheExposure) {
    const auto level = [](float h) { return [h](int, int) { return std::array{h, h, h}; }; };
    write("grey.exr", "portra-400", "400", level(0.025F));
    ConvertOptions options = on("endura");
    options.dither = color::Dither::kNone;
    const Bytes grey = pixels("grey.png", options, "grey.exr");
    EXPECT_EQ(grey[0], grey[1]);
    EXPECT_EQ(grey[1], grey[2]);
    // 0.18 of the light is 0.222 of the paper's white, whose Y is 0.811: code 130.
    EXPECT_NEAR(static_cast<int>(grey[0]), 130, 1);
    write("double.exr", "portra-400", "400", level(0.05F));
    options.stops = {1};
    const Bytes pushed = pixels("pushed.png", options, "grey.exr");
    options.stops = {0};
    EXPECT_EQ(pixels("double.png", options, "double.exr"), pushed);
    // The card of a film that was exposed for another index prints the same.
    write("other.exr", "portra-400", "200", level(0.05F));
    const Bytes other = pixels("other.png", options, "other.exr");
    EXPECT_NEAR(static_cast<int>(other[0]), 130, 1);
    EXPECT_EQ(other[0], other[2]);
}

// By default, as a camera with a light meter does: the whole picture becomes a grey card, however bright its light is.
TEST_F(FilmPrint, IsOfAFilmExposedForTheMeanOfThePictureUnlessASensitivityIsGiven) {
    const auto code = [&](const std::string& output) { return static_cast<int>(image::decode_png(folder_ / output).pixels[0]); };
    const auto tool = [&](const std::string& input, std::vector<std::string> more) {
        more.insert(more.begin(), {at(input), "-o", at("a.png"), "--no-dither", "--force"});
        const testing::Outcome done = run_tool(more);
        EXPECT_EQ(done.status, 0) << done.err;
        return done.out;
    };
    for (const auto& [film, paper] : {std::pair{"portra-400", "endura"}, {"portra-400", "scan"}, {"velvia-50", "light-table"}}) {
        SCOPED_TRACE(std::string(film) + " " + paper);
        const auto level = [](float h) { return [h](int, int) { return std::array{h, h, h}; }; };
        write("card.exr", film, "400", level(0.025F));
        write("bright.exr", film, "400", level(30));
        tool("card.exr", {"--paper", paper, "-s", "1"});
        const int card = code("a.png");
        EXPECT_THAT(tool("bright.exr", {"--paper", paper}), HasSubstr("chosen from the picture"));
        EXPECT_NEAR(code("a.png"), card, 1);
        tool("bright.exr", {"--paper", paper, "--crop", "0,0,7,5", "--stops", "1"});
        const int brighter = code("a.png");
        EXPECT_GT(brighter, card + 5);
        tool("bright.exr", {"--paper", paper, "--key", "0.36"});
        EXPECT_NEAR(code("a.png"), brighter, 1);
        tool("bright.exr", {"--paper", paper, "-s", "1"});
        EXPECT_GT(code("a.png"), brighter);
    }
}

TEST_F(FilmPrint, ExposuresThatAreNotFiniteAreCountedAndOthersPrintAsBefore) {
    write("odd.exr", "portra-400", "400", [](int x, int y) {
        std::array<float, 3> h = exposures(x, y);
        if (y == 0 && x == 3) h[1] = std::numeric_limits<float>::quiet_NaN();
        if (y == 0 && x == 5) h[2] = std::numeric_limits<float>::infinity();
        return h;
    });
    for (const char* paper : {"endura", "scan"}) {
        ConvertOptions options = on(paper);
        options.sensitivity = 1;
        options.dither = color::Dither::kNone;
        const Result<ConvertReport> report = print("odd.exr", std::string(paper) + ".png", options);
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_EQ(report->print.nan, 1u);
        EXPECT_EQ(report->print.infinite, 1u);
        Bytes odd = image::decode_png(folder_ / (std::string(paper) + ".png")).pixels, plain = pixels("plain.png", options);
        std::filesystem::remove(folder_ / "plain.png");
        for (const std::size_t x : {3, 5}) std::fill_n(odd.begin() + 3 * static_cast<std::ptrdiff_t>(x), 3, plain[0]);
        for (const std::size_t x : {3, 5}) std::fill_n(plain.begin() + 3 * static_cast<std::ptrdiff_t>(x), 3, plain[0]);
        EXPECT_EQ(odd, plain);
    }
}

TEST_F(FilmPrint, OfAnotherFilmThanTheExposedOneIsRefused) {
    ConvertOptions options = on("endura");
    options.darkroom.film = "portra-160";
    const Result<ConvertReport> report = print("film.exr", "a.png", options);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::kUsage);
    EXPECT_THAT(report.error().message, HasSubstr("exposures of portra-400, not of portra-160"));
}

TEST_F(FilmPrint, SaysWhatItWasMadeOf) {
    const Result<ConvertReport> report = print("film.exr", "a.png", on("endura"));
    ASSERT_TRUE(report);
    EXPECT_EQ(report->film, "portra-400 on endura, filters 54Y 46M 0C");
    EXPECT_EQ(report->tone, "paper");
    bool found = false;
    for (const auto& [key, text] : image::decode_png(folder_ / "a.png").texts)
        found = found || (key == "Film" && text == report->film);
    EXPECT_TRUE(found);
}

TEST_F(FilmPrint, WithoutAPaperOrOfWhatIsNotOnFilmIsRefusedWithWhatToDo) {
    write_picture(folder_ / "xyz.exr", {});
    write("unknown.exr", "kodachrome-2000");
    const auto refused = [&](const std::string& input, const ConvertOptions& options) {
        const Result<ConvertReport> report = print(input, "refused.png", options);
        EXPECT_FALSE(report);
        EXPECT_FALSE(std::filesystem::exists(folder_ / "refused.png"));
        if (!report) {
            EXPECT_EQ(report.error().code, ErrorCode::kUsage);
        }
        return report ? "" : report.error().message;
    };
    EXPECT_THAT(refused("film.exr", {}), AllOf(HasSubstr("exposures of a film, portra-400"), HasSubstr("--paper endura")));
    EXPECT_THAT(refused("xyz.exr", on("endura")), AllOf(HasSubstr("xyz.exr"), HasSubstr("latent-develop FILE.latent --film")));
    EXPECT_THAT(refused("unknown.exr", on("endura")),
                AllOf(HasSubstr("unknown film 'kodachrome-2000'"), HasSubstr("--film FOLDER/NAME")));
    EXPECT_THAT(refused("film.exr", on("projection")), HasSubstr("portra-400 is a colour negative"));
    ConvertOptions options = on("endura");
    options.tone = "reinhard";
    EXPECT_THAT(refused("film.exr", options), HasSubstr("--tone: does not go with --paper"));
    options = on("endura");
    options.darkroom.contrast_filter = "3";
    EXPECT_THAT(refused("film.exr", options), HasSubstr("--contrast-filter"));
    options = {};
    options.darkroom.print_stops = 1;
    EXPECT_THAT(refused("xyz.exr", options), HasSubstr("--print-exposure: needs --paper"));
    options = {};
    options.darkroom.couplers = false;
    EXPECT_THAT(refused("xyz.exr", options), HasSubstr("--no-couplers: needs --paper"));
    options = on("endura");
    options.darkroom.seed = 2;
    EXPECT_THAT(refused("film.exr", options), HasSubstr("--grain-seed: needs --grain"));
}

// Otherwise exposures would be printed as colours.
TEST_F(FilmPrint, OfAHeaderWithoutAnExposureIndexIsRefused) {
    for (const char* index : {"fast", "0", "-5", "nan", ""}) {
        write("damaged.exr", "portra-400", index);
        for (const ConvertOptions& options : {ConvertOptions{}, on("endura")}) {
            const Result<ConvertReport> report = print("damaged.exr", "refused.png", options);
            ASSERT_FALSE(report) << index;
            EXPECT_THAT(report.error().message, AllOf(HasSubstr("damaged.exr"), HasSubstr("latentExposureIndex")));
        }
    }
}

TEST_F(FilmPrint, OptionsAreReadFromTheCommandLine) {
    const testing::Outcome done = run_tool(
        {at("film.exr"), "-o", at("a.png"), "--paper", "supra endura", "--enlarger", "60,50,0", "--grain", "--format", "6x7"});
    EXPECT_EQ(done.status, 0) << done.err;
    EXPECT_THAT(done.out, HasSubstr("filters 60Y 50M 0C"));
    EXPECT_EQ(run_tool({at("film.exr"), "-o", at("b.png"), "--paper", "endura", "--enlarger", "60,50"}).status, 2);
    EXPECT_EQ(run_tool({at("film.exr"), "-o", at("b.png"), "--paper", "endura", "--format", "thumb"}).status, 2);
    EXPECT_THAT(run_tool({"--list-papers"}).out, AllOf(HasSubstr("endura"), HasSubstr("light-table")));
}

}  // namespace
}  // namespace latent::convert
