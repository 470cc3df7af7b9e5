// Views of the darkroom beside the prints of latent-print.
#include "tools/darkroom/engine/engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "color/observer.h"
#include "image/exr_reader.h"
#include "tests/image/decode.h"
#include "tests/print/samples.h"

namespace latent::testing {
namespace {

using darkroom::Engine;
using image::Rect;

class DarkroomEngine : public Samples {
 protected:
    static std::unique_ptr<Engine> open(std::uint64_t memory = std::uint64_t{1} << 30) {
        auto engine = Engine::open({{path("a.latent")}, false, memory, 2});
        EXPECT_TRUE(engine) << engine.error().message;
        return *std::move(engine);
    }
    static Recipe recipe_of(const std::string& sections) {
        const Result<Recipe> recipe = parse_recipe(R"({"latent-recipe": 1)" + (sections.empty() ? "" : ", " + sections) + "}");
        EXPECT_TRUE(recipe) << recipe.error().message;
        return *recipe;
    }
    // What latent-print writes with `recipe`, decoded.
    static image::Decoded printed(const Recipe& recipe, std::vector<std::string> options) {
        const std::string file = write("r.json", recipe.dump());
        options.insert(options.end(), {"--recipe", file, "-o", path("p.png")});
        make("latent-print", "a.latent", options);
        return image::decode_png(path("p.png"));
    }
    // Whether `view` has the code values of `print` from (x, y) on.
    static bool is_part(const convert::CodeValues& view, const image::Decoded& print, int x, int y) {
        const auto channels = static_cast<std::size_t>(view.channels), row = channels * static_cast<std::size_t>(view.width);
        if (print.format.channels != view.channels || view.codes.size() != row * static_cast<std::size_t>(view.height))
            return false;
        for (int i = 0; i < view.height; ++i) {
            const auto from = static_cast<std::size_t>((y + i) * print.format.width + x) * channels;
            for (std::size_t k = 0; k < row; ++k) {
                if (static_cast<int>(view.codes[static_cast<std::size_t>(i) * row + k]) != static_cast<int>(print.pixels[from + k]))
                    return false;
            }
        }
        return true;
    }
};

const char* const kRecipes[] = {
    "",
    R"("convert": {"stops": 1.5, "white": "A", "tone": "filmic", "contrast": 1.3, "gamut": "grey"})",
    R"("develop": {"light": ["lamp=0"]}, "convert": {"profile": "display-p3"})",
    R"("develop": {"light": ["sky=6500K,0.25", "lamp=2.5"], "filter": "box"}, "convert": {"stops": -1, "dither": "blue"})",
    R"("develop": {"denoise": 0.5}, "convert": {"key": 0.3, "show": "clipped"})",
    R"("develop": {"observer": "canon_eos_5d"}, "convert": {"sensitivity": 2, "dither": "none"})",
    R"("develop": {"lens-filter": "wratten-25"}, "convert": {"gray": true})",
    R"("develop": {"film": "kodak-portra-400"}, "convert": {"paper": "scan", "grain": true})",
    R"("develop": {"dim-fireflies": true, "estimator": "ratio"}, "convert": {"auto": true, "tone": "none"})",
    R"("develop": {"fraction": 0.5}, "convert": {"glare": "f:16", "vignette": "cos4", "bits": 8})",
};

TEST_F(DarkroomEngine, AViewHasTheBytesOfThePrint) {
    const std::unique_ptr<Engine> engine = open();
    for (const char* sections : kRecipes) {
        SCOPED_TRACE(sections);
        const Result<Recipe> recipe = engine->resolve(recipe_of(sections));
        ASSERT_TRUE(recipe) << recipe.error().message;
        for (const std::uint32_t width : {75u, 300u}) {
            const Result<develop::Size> size = engine->size_of_width(width);
            ASSERT_TRUE(size);
            const image::Decoded print = printed(*recipe, {"--size", std::to_string(width)});
            ASSERT_EQ(print.format.width, static_cast<int>(width));
            for (const Rect& area :
                 {Rect{0, 0, static_cast<int>(size->width), static_cast<int>(size->height)}, Rect{13, 7, 62, 41}}) {
                const Result<convert::CodeValues> view = engine->view(*recipe, *size, area);
                ASSERT_TRUE(view) << view.error().message;
                EXPECT_TRUE(is_part(*view, print, area.x0, area.y0)) << width;
            }
        }
    }
}

// A crop cuts the print, and changes no pixel.
TEST_F(DarkroomEngine, AViewShowsWhatACropLeavesOut) {
    const std::unique_ptr<Engine> engine = open();
    const Result<Recipe> recipe =
        engine->resolve(recipe_of(R"("develop": {"size": 150, "crop": "20,10,120,90"}, "convert": {"crop": "30,20,100,80"})"));
    ASSERT_TRUE(recipe) << recipe.error().message;
    const Result<convert::CodeValues> view = engine->view(*recipe, {150, 100}, {30, 20, 100, 80});
    ASSERT_TRUE(view) << view.error().message;
    EXPECT_TRUE(is_part(*view, printed(*recipe, {}), 0, 0));
    EXPECT_TRUE(engine->view(*recipe, {150, 100}, {0, 0, 150, 100}));
}

// Pictures of more than 2048 x 2048 pixels are developed in squares; the least memory keeps one of them at a time.
TEST_F(DarkroomEngine, PartsOfALargePictureFitTogetherWhateverTheMemory) {
    const Recipe recipe = recipe_of(R"("convert": {"sensitivity": 1}, "develop": {"light": ["lamp=3"]})");
    const image::Decoded print = printed(recipe, {"--size", "3000"});
    for (const std::uint64_t memory : {std::uint64_t{96} << 20, std::uint64_t{1} << 30}) {
        const std::unique_ptr<Engine> engine = open(memory);
        for (const Rect& area : {Rect{1990, 1900, 2200, 2000}, Rect{2040, 0, 2060, 300}, Rect{0, 1999, 3000, 2000}}) {
            const Result<convert::CodeValues> view = engine->view(recipe, {3000, 2000}, area);
            ASSERT_TRUE(view) << view.error().message;
            EXPECT_TRUE(is_part(*view, print, area.x0, area.y0));
        }
    }
}

TEST_F(DarkroomEngine, AChosenExposureIsNearThatOfThePrint) {
    const std::unique_ptr<Engine> engine = open();
    const Result<Recipe> recipe = engine->resolve(recipe_of(R"("convert": {"auto": true})"));
    ASSERT_TRUE(recipe);
    EXPECT_FALSE((*recipe)["convert"].contains("auto"));
    // The size that is metered is the size that was rendered for: so the exposure is the same.
    const Recipe automatic = recipe_of(R"("convert": {"auto": true})");
    EXPECT_EQ(printed(*recipe, {}).pixels, printed(automatic, {}).pixels);
}

TEST_F(DarkroomEngine, AProbeTellsThePixelOfThePicture) {
    const std::unique_ptr<Engine> engine = open();
    const Result<Recipe> recipe = engine->resolve(recipe_of(R"("develop": {"light": ["lamp=2"]})"));
    ASSERT_TRUE(recipe);
    const Result<darkroom::Probe> probe = engine->probe(*recipe, {300, 200}, 150, 100);
    ASSERT_TRUE(probe) << probe.error().message;
    const Result<convert::CodeValues> view = engine->view(*recipe, {300, 200}, {150, 100, 151, 101});
    ASSERT_TRUE(view);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(probe->codes[c], static_cast<int>(view->codes[c]));
        EXPECT_GT(probe->values[c], 0);
        EXPECT_GT(probe->standard_errors[c], 0);
        EXPECT_LT(probe->standard_errors[c], probe->values[c]);
    }
    EXPECT_GT(probe->samples, 0);
}

// Though the probe develops no more than its pixel.
TEST_F(DarkroomEngine, AProbeHasTheCodesOfTheView) {
    const std::unique_ptr<Engine> engine = open();
    for (const char* sections : kRecipes) {
        SCOPED_TRACE(sections);
        const Result<Recipe> recipe = engine->resolve(recipe_of(sections));
        ASSERT_TRUE(recipe) << recipe.error().message;
        for (const auto& [x, y] : {std::pair{0, 0}, {150, 100}, {170, 60}, {299, 199}}) {
            const Result<darkroom::Probe> probe = engine->probe(*recipe, {300, 200}, x, y);
            ASSERT_TRUE(probe) << probe.error().message;
            const Result<convert::CodeValues> view = engine->view(*recipe, {300, 200}, {x, y, x + 1, y + 1});
            ASSERT_TRUE(view);
            for (std::size_t c = 0; c < view->codes.size(); ++c) EXPECT_EQ(probe->codes[c], static_cast<int>(view->codes[c]));
        }
    }
}

// Bins as latent-develop stores them; weighed by ybar, they add up to the Y of the probe.
TEST_F(DarkroomEngine, ASpectrumIsThatOfThePixelAndItsLuminance) {
    const std::unique_ptr<Engine> engine = open();
    const Recipe recipe = recipe_of(R"("develop": {"light": ["lamp=F11,wratten-80a,2"]}, "convert": {"sensitivity": 1})");
    constexpr int kBins = 94;
    const Result<darkroom::ProbedSpectrum> spectrum = engine->spectrum(recipe, {75, 50}, 40, 25, kBins);
    ASSERT_TRUE(spectrum) << spectrum.error().message;
    const Result<darkroom::Probe> probe = engine->probe(recipe, {75, 50}, 40, 25);
    ASSERT_TRUE(probe);
    EXPECT_EQ(spectrum->samples, probe->samples);

    develop::PictureOptions options;
    options.inputs = {path("a.latent")};
    options.size = "75x50";
    options.crop = develop::PixelRect{40, 25, 41, 26};
    options.lights = {"lamp=F11,wratten-80a,2"};
    options.spectral_bins.count = kBins;
    options.layers.variance = true;
    develop::PixelArray pixel;
    ASSERT_TRUE(develop::develop_picture(options, pixel, {}));
    const double width = 470.0 / kBins;
    double y = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
        EXPECT_EQ(spectrum->values[i], static_cast<double>(pixel.pixels()[i]));
        EXPECT_EQ(spectrum->standard_errors[i], std::sqrt(pixel.pixels()[kBins + i]));
        const double nm = spectrum->from_nm + (static_cast<double>(i) + 0.5) * width;
        y += 683 * color::Observer::cie1931().at(nm)[1] * spectrum->values[i] * width;
    }
    EXPECT_NEAR(y / engine->runs()->job().light_unit_cd_m2, probe->values[1], 0.01 * probe->values[1]);  // ybar within 5 nm
}

TEST_F(DarkroomEngine, TheNoiseMapIsThatOfInspectNoise) {
    const std::unique_ptr<Engine> engine = open();
    const Result<develop::NoiseMap> map = engine->noise(recipe_of(R"("convert": {"sensitivity": 1})"), {300, 200});
    ASSERT_TRUE(map) << map.error().message;
    const Outcome told = run({tool("latent-inspect"), "noise", path("a.latent"), "--size", "300", "-o", path("n.exr")});
    ASSERT_EQ(told.status, 0) << told.err;
    const Result<image::ExrReader> reader = image::ExrReader::open(path("n.exr"));
    ASSERT_TRUE(reader) << reader.error().message;
    std::vector<float> planes[3];
    for (auto& plane : planes) plane.resize(std::size_t{300} * 200);
    image::ExrReader::Scratch scratch;
    ASSERT_TRUE(reader->read({0, 0, 300, 200}, {planes[0].data(), planes[1].data(), planes[2].data()}, 300, scratch));
    constexpr std::size_t kSide = develop::NoiseMap::kSide;
    EXPECT_EQ(map->columns(), 19U);
    EXPECT_EQ(map->rows(), 13U);
    for (std::size_t row = 0; row < map->rows(); ++row) {
        for (std::size_t column = 0; column < map->columns(); ++column)
            EXPECT_EQ(map->relative(column, row), planes[0][row * kSide * 300 + column * kSide]);
    }
    EXPECT_EQ(engine->noise(Recipe::object(), {4096, 2731}).error().code, ErrorCode::kUsage);
}

TEST_F(DarkroomEngine, AHistogramCountsThePixelsOfTheView) {
    const std::unique_ptr<Engine> engine = open();
    const Recipe recipe = recipe_of(R"("convert": {"sensitivity": 40})");
    const Result<darkroom::Histogram> histogram = engine->histogram(recipe, {150, 100});
    ASSERT_TRUE(histogram) << histogram.error().message;
    const Result<convert::CodeValues> view = engine->view(recipe, {150, 100}, {0, 0, 150, 100});
    ASSERT_TRUE(view);
    std::array<std::array<std::uint64_t, 256>, 3> counts{};
    for (std::size_t i = 0; i < view->codes.size(); ++i) ++counts[i % 3][static_cast<std::size_t>(view->codes[i])];
    EXPECT_EQ(histogram->counts, counts);
    EXPECT_EQ(histogram->pixels, 15000u);
    EXPECT_GT(histogram->burnt, 0u);
    const Result<darkroom::Histogram> marked =
        engine->histogram(recipe_of(R"("convert": {"sensitivity": 40, "show": "clipped"})"), {150, 100});
    ASSERT_TRUE(marked);
    EXPECT_EQ(marked->counts, counts);
    EXPECT_EQ(marked->burnt, histogram->burnt);
}

// Once the groups are there, any mix of them is made without reading samples.
TEST_F(DarkroomEngine, AMixOfGroupsIsThePrintButForLastDigits) {
    const std::unique_ptr<Engine> engine = open();
    const Rect all{0, 0, 300, 200};
    std::uint64_t read = 0;
    for (const char* sections :
         {R"("convert": {"sensitivity": 1, "dither": "none"})",
          R"("develop": {"light": ["lamp=2.5", "sky=0.3"]}, "convert": {"sensitivity": 1, "dither": "none"})",
          R"("develop": {"light": "sky=0"}, "convert": {"sensitivity": 2, "dither": "none"})"}) {
        SCOPED_TRACE(sections);
        const Recipe recipe = recipe_of(sections);
        ASSERT_TRUE(engine->resolve(recipe, {.mixed = true}));
        const Result<convert::CodeValues> mixed = engine->view(recipe, {300, 200}, all, {.mixed = true});
        ASSERT_TRUE(mixed) << mixed.error().message;
        if (read > 0) {
            EXPECT_EQ(engine->runs()->bytes_read(), read);
        }
        const Result<convert::CodeValues> exact = engine->view(recipe, {300, 200}, all);
        ASSERT_TRUE(exact);
        EXPECT_NE(engine->runs()->bytes_read(), read);
        read = engine->runs()->bytes_read();
        ASSERT_EQ(mixed->codes.size(), exact->codes.size());
        int largest = 0, different = 0;
        for (std::size_t i = 0; i < exact->codes.size(); ++i) {
            const int difference = std::abs(static_cast<int>(mixed->codes[i]) - static_cast<int>(exact->codes[i]));
            largest = std::max(largest, difference);
            different += difference;
        }
        EXPECT_LE(largest, 1);
        EXPECT_LE(different, 18);  // 1e-4 of the values lie so close to a step
    }
    // Another lamp in one of them is another picture of it, of the same brightness.
    const Recipe warm = recipe_of(R"("develop": {"light": ["lamp=3000K,0.5"]}, "convert": {"sensitivity": 1, "dither": "none"})");
    const Result<convert::CodeValues> mixed = engine->view(warm, {300, 200}, all, {.mixed = true});
    const Result<convert::CodeValues> exact = engine->view(warm, {300, 200}, all);
    ASSERT_TRUE(mixed && exact);
    for (std::size_t i = 0; i < exact->codes.size(); ++i)
        ASSERT_NEAR(static_cast<int>(mixed->codes[i]), static_cast<int>(exact->codes[i]), 1) << i;
}

TEST_F(DarkroomEngine, WhatIsGivenUpLeavesTheRestAsItWas) {
    const std::unique_ptr<Engine> engine = open();
    const Recipe recipe = recipe_of(R"("convert": {"sensitivity": 1})");
    const Result<convert::CodeValues> none = engine->view(recipe, {300, 200}, {0, 0, 300, 200}, {.stopped = [] { return true; }});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::kStopped);
    const Result<convert::CodeValues> view = engine->view(recipe, {300, 200}, {0, 0, 300, 200});
    ASSERT_TRUE(view);
    EXPECT_TRUE(is_part(*view, printed(recipe, {"--size", "300"}), 0, 0));
}

// Parts of a render that goes on: one more, one that is cut off as it is written, one that is gone for a while.
TEST_F(DarkroomEngine, SamplesThatComeAreSeenAndNoneAreLost) {
    namespace fs = std::filesystem;
    const fs::path parts = path("parts");
    fs::create_directory(parts);
    const auto render = [&](const std::string& samples, const std::string& name) {
        make("latent-render", "scene.pbrt", {"-o", path(name), "--samples", samples, "--run-samples", "16384", "--light-groups"});
    };
    render("0:32768", "parts/a.latent");
    render("32768:65536", "b.latent");
    auto opened = Engine::open({{parts}, false, std::uint64_t{1} << 30, 2});
    ASSERT_TRUE(opened) << opened.error().message;
    Engine& engine = **opened;
    const Recipe recipe = recipe_of(R"("convert": {"sensitivity": 1})");
    const auto seen = [&] {
        const Result<convert::CodeValues> view = engine.view(recipe, {300, 200}, {0, 0, 300, 200});
        EXPECT_TRUE(view) << view.error().message;
        return view ? view->codes : std::vector<std::byte>();
    };
    const std::vector<std::byte> before = seen();
    EXPECT_FALSE(engine.look_again());

    fs::copy_file(path("b.latent"), parts / "b.latent.part.0123456789abcdef");
    fs::resize_file(parts / "b.latent.part.0123456789abcdef", fs::file_size(path("b.latent")) * 3 / 4);  // as a kill leaves it
    EXPECT_TRUE(engine.look_again());
    EXPECT_EQ(engine.runs()->coverage().size(), 49152u);
    const std::vector<std::byte> partial = seen();
    EXPECT_NE(partial, before);

    fs::remove(parts / "b.latent.part.0123456789abcdef");
    EXPECT_FALSE(engine.look_again());
    EXPECT_EQ(engine.runs()->coverage().size(), 49152u);
    EXPECT_EQ(seen(), partial);

    fs::copy_file(path("b.latent"), parts / "b.latent");
    EXPECT_TRUE(engine.look_again());
    EXPECT_EQ(engine.runs()->coverage().size(), 65536u);
    const std::string file = write("r.json", recipe.dump());
    make("latent-print", "parts", {"--recipe", file, "-o", path("p.png")});
    const image::Decoded print = image::decode_png(path("p.png"));
    EXPECT_EQ(seen(), print.pixels);

    fs::rename(parts, path("elsewhere"));
    EXPECT_FALSE(engine.look_again());
    EXPECT_EQ(seen(), print.pixels);
}

TEST_F(DarkroomEngine, WhatOnlyAPrintCanHaveIsSaid) {
    const std::unique_ptr<Engine> engine = open();
    const auto refused = [&](const std::string& sections, const std::string& why) {
        const Result<Recipe> recipe = engine->resolve(recipe_of(sections));
        ASSERT_FALSE(recipe);
        EXPECT_EQ(recipe.error().code, ErrorCode::kUsage);
        EXPECT_NE(recipe.error().message.find(why), std::string::npos) << recipe.error().message;
    };
    refused(R"("convert": {"level": 1})", "--level: a view has the sizes that are asked for");
    refused(R"("convert": {"white": "1,2,3,4"})", "--white: a view needs a chromaticity");
    refused(R"("develop": {"light": ["lampe=2"]})", "lampe");
    refused(R"("develop": {"lihgt": 2})", "did you mean light?");
    refused(R"("convert": {"dpi": 200, "paper-width": 100})", "--paper-width");
}

}  // namespace
}  // namespace latent::testing
