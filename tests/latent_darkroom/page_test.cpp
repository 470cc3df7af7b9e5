// The page in Chromium: what each control shows is what the command line prints.
#include <fmt/format.h>

#include <fstream>

#include "tests/image/decode.h"
#include "tests/latent_darkroom/served.h"

namespace latent::testing {
namespace {

class DarkroomPage : public Served {
 protected:
    // What drive.mjs saw after each step.
    Json drive(const Json& steps) {
        const std::string script = in_tree("tests/latent_darkroom/browser/drive.mjs");
        const std::string file = write("steps.json", steps.dump());
        std::filesystem::create_directories(path("seen"));
        const Outcome outcome = run({"/bin/sh", "-c", "exec node \"$0\" \"$1\" \"$2\" 1280x720 < \"$3\"", script,
                                     "http://127.0.0.1:" + std::to_string(port_) + base_, path("seen"), file});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const Json told = Json::parse(outcome.out, nullptr, false);
        EXPECT_TRUE(told.is_object()) << outcome.out;
        // OpenSeadragon adds a rule for phones that lie on their side, which the policy forbids.
        EXPECT_LE(told["complaints"].size(), 1u) << told["complaints"];
        return told["seen"];
    }
    static image::Decoded printed(const std::vector<std::string>& options) {
        make("latent-print", "a.latent", with(options, {"-o", path("p.png")}));
        return image::decode_png(path("p.png"));
    }
    static std::string sensitivity_of(const image::Decoded& print) {
        for (const auto& [key, value] : print.texts) {
            if (key == "Sensitivity") return value;
        }
        return "";
    }
    static std::string bytes_from_base64(const std::string& text) {
        std::string bytes;
        std::uint32_t bits = 0;
        int count = 0;
        for (const char c : text) {
            constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
            const std::size_t digit = kDigits.find(c);
            if (digit == std::string_view::npos) break;
            bits = bits << 6 | static_cast<std::uint32_t>(digit), count += 6;
            if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 0xff);
        }
        return bytes;
    }
    static bool is_same(const std::string& bytes, const image::Decoded& print) {
        return bytes.size() == print.pixels.size() &&
               std::equal(bytes.begin(), bytes.end(), print.pixels.begin(),
                          [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
    }
};

TEST_F(DarkroomPage, EachControlPrintsAsTheCommandLine) {
    struct Step {
        Json done;
        std::vector<std::string> options;  // that are added
    };
    const std::vector<Step> steps = {
        {{{"set", {{"stops", "1"}}}}, {"--stops", "1"}},
        {{{"set", {{"denoise", "1"}, {"fireflies", true}}}}, {"--denoise=1", "--dim-fireflies"}},
        {{{"set", {{"white", "A"}}}}, {"--white", "A"}},
        {{{"set", {{"tone", "filmic"}, {"contrast", "1.3"}, {"black", "0.02"}}}},
         {"--tone", "filmic", "--contrast", "1.3", "--black", "0.02"}},
        {{{"set", {{"gamut", "grey"}, {"profile", "display-p3"}}}}, {"--gamut", "grey", "--profile", "display-p3"}},
        {{{"set", {{"[aria-label='Stops of sky']", "-1.5"}}}}, {"--light", "sky=0.353553"}},
        {{{"set", {{"[aria-label='Colour of lamp']", "3000"}}}}, {"--light", "lamp=3000K"}},
        {{{"set", {{"observer", "cie1964"}, {"filter", "wratten-81"}}}}, {"--observer", "cie1964", "--lens-filter", "wratten-81"}},
        {{{"click", "clipped"}}, {"--show", "clipped"}},
    };
    Json done = Json::array({Json::object()});
    for (const Step& step : steps) done.push_back(step.done);
    done.push_back({{"click", "undo"}});
    done.push_back({{"click", "reset"}});
    const Json seen = drive(done);
    ASSERT_EQ(seen.size(), done.size());

    const image::Decoded automatic = printed({});
    EXPECT_TRUE(is_same(bytes_from_base64(seen[0]["tile"]), automatic));
    std::vector<std::string> options{"--sensitivity", sensitivity_of(automatic)};
    std::vector<std::string> views{seen[0]["view"]};
    for (std::size_t i = 0; i < steps.size(); ++i) {
        SCOPED_TRACE(steps[i].done.dump());
        options = with(options, steps[i].options);
        EXPECT_EQ(seen[i + 1]["error"], "");
        EXPECT_TRUE(is_same(bytes_from_base64(seen[i + 1]["tile"]), printed(options)));
        EXPECT_NE(seen[i + 1]["tile"], seen[i]["tile"]);
        const bool is_mix = steps[i].options[1].starts_with("sky=");  // which is seen before it is developed
        EXPECT_EQ(seen[i + 1]["mixed"] > seen[i]["mixed"], is_mix);
        views.push_back(seen[i + 1]["view"]);
    }
    EXPECT_EQ(seen[steps.size() + 1]["view"], views[steps.size() - 1]);
    EXPECT_EQ(seen[steps.size() + 2]["view"], views[0]);
}

TEST_F(DarkroomPage, ExposuresOfCamerasAreThoseOfTheCommandLine) {
    const Json seen = drive({{{"set", {{"iso", "3200"}}}},
                             {{"set", {{"time", "2"}}}},
                             {{"set", {{"f-number", "1.4"}}}, {"shot", "camera.png"}},
                             {{"set", {{"stops", "1"}}}},
                             {{"set", {{"stops", "0"}, {"iso", ""}}}}});
    const std::vector<std::vector<std::string>> options = {{"--exposure", "iso:3200,time:1/125,f:8"},
                                                           {"--exposure", "iso:3200,time:2,f:8"},
                                                           {"--exposure", "iso:3200,time:2,f:1.4"},
                                                           {"--exposure", "iso:3200,time:2,f:1.4", "--stops", "1"},
                                                           {}};
    for (std::size_t i = 0; i < options.size(); ++i) {
        EXPECT_EQ(seen[i]["error"], "");
        EXPECT_TRUE(is_same(bytes_from_base64(seen[i]["tile"]), printed(options[i]))) << i;
    }
}

TEST_F(DarkroomPage, LampsAndGelsAreThoseOfTheCommandLine) {
    const std::string lamp = "[aria-label='Colour of lamp']", gel = "[aria-label='Gel of lamp']";
    const Json seen = drive({{{"set", {{gel, "wratten-80a, wratten-3"}}}, {"shot", "gel.png"}},
                             {{"set", {{lamp, "F11"}}}},
                             {{"set", {{gel, ""}, {"[aria-label='Colour of sky']", "6500k"}}}},
                             {{"set", {{lamp, "moon"}}}},
                             {{"set", {{gel, "moon"}}}}});
    const std::vector<std::string> exposed{"--sensitivity", sensitivity_of(printed({}))};
    const std::vector<std::string> lights[] = {{"--light", "lamp=wratten-80a,wratten-3"},
                                               {"--light", "lamp=F11,wratten-80a,wratten-3"},
                                               {"--light", "lamp=F11", "--light", "sky=6500K"}};
    for (std::size_t i = 0; i < std::size(lights); ++i) {
        EXPECT_EQ(seen[i]["error"], "");
        EXPECT_TRUE(is_same(bytes_from_base64(seen[i]["tile"]), printed(with(exposed, lights[i])))) << i;
    }
    EXPECT_EQ(seen[3]["error"], "moon: not a temperature, such as 3200K, or the name of a light");
    EXPECT_EQ(seen[3]["view"], seen[2]["view"]);
    EXPECT_NE(std::string(seen[4]["error"]).find("'moon' is not"), std::string::npos) << seen[4]["error"];
}

TEST_F(DarkroomPage, FilmPaperGlareAndProofsAreThoseOfTheCommandLine) {
    const std::string profile = "/usr/share/color/icc/ghostscript/default_cmyk.icc";
    ASSERT_TRUE(std::filesystem::exists(profile));
    const Json seen =
        drive({{{"set", {{"look", "portrait"}}}},
               {{"set", {{"paper", "endura"}}}},
               {{"set", {{"enlarger", "0.5"}}}},
               {{"click", "grain"}},
               {{"click", "eye-films"}, {"wait", "#thumbnails button:last-child img[alt^='The print']"}, {"shot", "films.png"}},
               {{"click", "#thumbnails button:nth-child(14)"}},
               {{"set", {{"film", ""}}}},
               {{"set", {{"glare", "f:8"}}}},
               {{"set", {{"proof", profile}, {"intent", "relative"}}}}});
    const auto is_seen = [&](std::size_t step, const std::vector<std::string>& options) {
        EXPECT_EQ(seen[step]["error"], "");
        const image::Decoded print = printed(options);
        EXPECT_TRUE(is_same(bytes_from_base64(seen[step]["tile"]), print)) << step;
        return sensitivity_of(print);
    };
    const std::vector<std::string> film{"--film", "portra-400"};
    is_seen(0, with(film, {"--look", "portrait"}));
    const std::string on_paper = is_seen(1, with(film, {"--paper", "endura"}));
    std::vector<std::string> options = with(film, {"--paper", "endura", "--sensitivity", on_paper, "--print-exposure", "0.5"});
    is_seen(2, options);
    is_seen(3, with(options, {"--grain"}));
    EXPECT_EQ(seen[4]["view"], seen[3]["view"]);
    is_seen(5, {"--film", seen[5]["recipe"]["develop"]["film"], "--paper", "scan"});
    EXPECT_NE(seen[5]["recipe"]["develop"]["film"], "portra-400");
    options = {"--sensitivity", is_seen(6, {}), "--glare", "f:8"};
    is_seen(7, options);
    is_seen(8, with(options, {"--proof", profile, "--intent", "relative"}));
}

TEST_F(DarkroomPage, TheLensAndTheShutterAreThoseOfTheCommandLine) {
    std::string scene = bytes_of("scene.pbrt");
    scene.insert(scene.find("\"float fov\""), "\"float lensradius\" 0.1 \"float focaldistance\" 2.4 ");
    scene.insert(scene.find("Shape"), "ActiveTransform EndTime Translate 0.3 0 0 ActiveTransform All\n");
    write("lens.pbrt", scene);
    ASSERT_NO_FATAL_FAILURE(
        make("latent-render", "lens.pbrt", {"-o", path("lens.latent"), "--samples", "0:65536", "--aov", "lens,time,depth"}));
    child_->send(SIGTERM);
    EXPECT_EQ(child_->wait(), 0);
    std::filesystem::remove(path("address"));
    ASSERT_NO_FATAL_FAILURE(start({}, "lens.latent"));
    const Json seen = drive({Json::object(),
                             {{"set", {{"shutter", "0:0.5"}}}},
                             {{"click", "exposure-follows"}},
                             {{"set", {{"shutter", ""}, {"aperture", "0.4"}}}},
                             {{"set", {{"blades", "6"}}}},
                             {{"set", {{"anamorphic", "1.5"}, {"cat-eye", "0.4"}}}},
                             {{"click", "gaussian"}, {"shot", "rim.png"}},
                             {{"set", {{"anamorphic", ""}, {"cat-eye", ""}}}},
                             {{"click", "gaussian"}},
                             {{"click", "focus-here"}, {"shot", "lens.png"}},
                             {{"at", {468, 360}}}});
    const auto printed_of_lens = [&](const std::vector<std::string>& options) {
        make("latent-print", "lens.latent", with(options, {"-o", path("p.png")}));
        return image::decode_png(path("p.png"));
    };
    const image::Decoded automatic = printed_of_lens({});
    const std::vector<std::string> options{"--sensitivity", sensitivity_of(automatic), "--shutter", "0:0.5"};
    EXPECT_TRUE(is_same(bytes_from_base64(seen[0]["tile"]), automatic));
    EXPECT_TRUE(is_same(bytes_from_base64(seen[1]["tile"]), printed_of_lens(options)));
    EXPECT_TRUE(is_same(bytes_from_base64(seen[2]["tile"]), printed_of_lens(with(options, {"--exposure-follows"}))));
    const auto through = [&](const std::string& aperture) {
        return std::vector<std::string>{options[0], options[1], "--exposure-follows", "--aperture", aperture};
    };
    EXPECT_EQ(seen[3]["error"], "");
    EXPECT_TRUE(is_same(bytes_from_base64(seen[3]["tile"]), printed_of_lens(through("f:0.4"))));
    const std::vector<std::string> bladed = through("f:0.4,blades:6");
    EXPECT_TRUE(is_same(bytes_from_base64(seen[4]["tile"]), printed_of_lens(bladed)));
    const std::string ovals = "f:0.4,blades:6,anamorphic:1.5,cat-eye:0.4";
    EXPECT_TRUE(is_same(bytes_from_base64(seen[5]["tile"]), printed_of_lens(through(ovals))));
    EXPECT_TRUE(is_same(bytes_from_base64(seen[6]["tile"]), printed_of_lens(through(ovals + ",gaussian"))));
    EXPECT_EQ(seen[8]["tile"], seen[4]["tile"]);
    const double focus = seen[10]["recipe"]["develop"]["focus"];
    EXPECT_NEAR(focus, 2.2, 0.1);  // the front of the sphere
    EXPECT_EQ(get("api/distance?width=300&x=0&y=0")["distance"], "infinity");
    EXPECT_TRUE(is_same(bytes_from_base64(seen[10]["tile"]), printed_of_lens(with(bladed, {"--focus", fmt::format("{}", focus)}))));
}

// The picture has 936 x 624 pixels of the screen, from 0,48 on.
TEST_F(DarkroomPage, WhatIsPaintedIsDodgedInThePrint) {
    const Json seen = drive({{{"set", {{"dodge-stops", "1"}, {"dodge-radius", "0.2"}}}},
                             {{"click", "brush"}},
                             {{"drag", {{234, 360}, {400, 360}, {702, 360}}}, {"shot", "brushed.png"}},
                             {{"set", {{"dodge-stops", "-2"}}}},
                             {{"click", "gradient"}},
                             {{"drag", {{468, 48}, {468, 204}, {468, 360}}}},
                             {{"click", "#dodges button"}}});
    const Json both = {"brush:1,0.2,0.25,0.5,0.4274,0.5,0.75,0.5", "gradient:-2,0.5,0,0.5,0.5"};
    EXPECT_EQ(seen[5]["recipe"]["convert"]["dodge"], both);
    EXPECT_EQ(seen[5]["error"], "");
    const std::vector<std::string> exposed{"--sensitivity", sensitivity_of(printed({}))};
    const std::vector<std::string> brushed = with(exposed, {"--dodge", both[0]}), burnt{"--dodge", both[1]};
    EXPECT_TRUE(is_same(bytes_from_base64(seen[2]["tile"]), printed(brushed)));
    EXPECT_TRUE(is_same(bytes_from_base64(seen[5]["tile"]), printed(with(brushed, burnt))));
    EXPECT_TRUE(is_same(bytes_from_base64(seen[6]["tile"]), printed(with(exposed, burnt))));
}

TEST_F(DarkroomPage, APrintForAPaperHasItsPixels) {
    const Json seen = drive({{{"set", {{"paper-width", "6"}, {"paper-height", "3"}, {"dpi", "127"}}}},
                             {{"click", "to-paper"}, {"shot", "paper.png"}},
                             {{"set", {{"name", "small"}, {"format", "tif"}}}},
                             {{"click", "print"}},
                             {{"wait", "#jobs li"}}});
    EXPECT_EQ(seen[1]["recipe"]["develop"]["size"], 300);
    EXPECT_EQ(seen[1]["recipe"]["develop"]["crop"], "0,25,300,175");
    EXPECT_EQ(seen[1]["recipe"]["convert"]["dpi"], 127);
    Json jobs = get("api/prints");
    for (; jobs[0]["state"] == "running"; jobs = get("api/prints")) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(jobs[0]["state"], "done") << jobs;
    const std::string file = write("r.json", seen[1]["recipe"].dump());
    make("latent-print", "a.latent", {"--recipe", file, "-o", path("same.tif")});
    EXPECT_TRUE(bytes_of("kept/small.tif") == bytes_of("same.tif"));
}

TEST_F(DarkroomPage, FiltersAreFoundAndChosenByEyeAndTheHistoryGoesBack) {
    const Json seen = drive({{{"set", {{"stops", {"0.4", "0.7", "1"}}}}},
                             {{"click", "eye-filters"}},
                             {{"set", {{"find", "25"}}},
                              {"wait", "#thumbnails button:not([hidden]) img[alt$='wratten-25']"},
                              {"tell", "#thumbnails button:not([hidden])"},
                              {"shot", "found.png"}},
                             {{"click", "#thumbnails button:not([hidden])"}, {"tell", "#history button"}, {"shot", "history.png"}},
                             {{"click", "#history li:last-child button"}, {"tell", "#history [aria-current]"}}});
    EXPECT_EQ(seen[2]["told"].size(), 1U) << seen[2]["told"];
    EXPECT_EQ(seen[3]["recipe"]["develop"]["lens-filter"], "wratten-25");
    EXPECT_EQ(seen[3]["told"][0]["text"], "lens-filter wratten-25");
    ASSERT_EQ(seen[3]["told"].size(), 3U) << seen[3]["told"];
    EXPECT_EQ(seen[3]["told"][1]["text"], "stops 1");
    EXPECT_EQ(seen[4]["told"][0]["text"], "the beginning");
    EXPECT_TRUE(is_same(bytes_from_base64(seen[4]["tile"]), printed({})));
}

TEST_F(DarkroomPage, RecipesAreRenamedDuplicatedAndLoaded) {
    const Json seen = drive({{{"set", {{"name", "dusk"}, {"stops", "-1"}}}},
                             {{"click", "save"}},
                             {{"click", "duplicate"}, {"tell", "#recipes option"}},
                             {{"set", {{"stops", "2"}, {"name", "noon"}}}},
                             {{"click", "rename"}, {"tell", "#recipes option"}},
                             {{"set", {{"recipes", "noon"}}}, {"tell", "#rename"}},
                             {{"set", {{"name", "dusk"}}}},
                             {{"click", "rename"}}});
    const auto names = [&](const Json& told) {
        std::string all;
        for (const Json& option : told) all += option["text"].get<std::string>() + ";";
        return all;
    };
    EXPECT_EQ(names(seen[2]["told"]), ";dusk;dusk 2;");
    EXPECT_EQ(names(seen[4]["told"]), ";dusk;noon;");
    EXPECT_EQ(seen[4]["recipe"]["convert"]["stops"], 2);  // what is shown stays
    EXPECT_EQ(seen[5]["recipe"]["convert"]["stops"], -1);
    EXPECT_TRUE(seen[5]["told"][0].contains("disabled"));
    EXPECT_EQ(seen[7]["error"], "there is a recipe of the name dusk already");
    EXPECT_EQ(get("api/recipes"), Json({"dusk", "noon"}));
}

TEST_F(DarkroomPage, TheNoiseMapFollowsTheLight) {
    const Json seen = drive({{{"key", "n"}, {"wait", "#noise-map"}, {"tell", "#noise-told"}, {"shot", "noise.png"}},
                             {{"set", {{"stops", "1"}}}, {"tell", "#noise-told"}},
                             {{"click", "[aria-label='Mute sky']"}, {"tell", "#noise-told"}},
                             {{"set", {{"denoise", "1"}}}, {"tell", "#noise-told"}},
                             {{"click", "noise"}, {"tell", "#noise-map"}}});
    const Json map = get("api/noise?width=300&view=" + std::string(seen[0]["view"]));
    const std::string text = seen[0]["told"][0]["text"];
    const std::size_t at = text.find("half above ") + 11;
    EXPECT_NEAR(std::stod(text.substr(at)), 100 * map["median"].get<double>(), 0.05 * 100 * map["median"].get<double>()) << text;
    EXPECT_EQ(seen[1]["told"], seen[0]["told"]);
    EXPECT_NE(seen[2]["told"], seen[0]["told"]);
    EXPECT_EQ(std::string(seen[3]["told"][0]["text"]), std::string(seen[2]["told"][0]["text"]) + " Before it is removed.");
    EXPECT_EQ(seen[4]["told"], Json::array());
    EXPECT_EQ(seen[4]["error"], "");
}

// The picture has 936 x 624 pixels of the screen, from 0,48 on.
TEST_F(DarkroomPage, CropsAreDrawnAndMeasuredByRulers) {
    const Json seen =
        drive({{{"click", "draw"}},
               {{"drag", {{234, 204}, {300, 300}, {702, 516}}}, {"shot", "drawn.png"}},
               {{"key", "r"}, {"tell", "#ruler-across text, #ruler-unit, #frame"}},
               {{"set", {{"dpi", "254"}}}, {"tell", "#ruler-across text, #ruler-unit, #frame"}, {"shot", "rulers.png"}},
               {{"set", {{"paper-width", "6"}, {"paper-height", "3"}, {"in-shape", true}}}},
               {{"key", "f"}},
               {{"click", "draw"}},
               {{"drag", {{249, 217}, {300, 300}, {707, 446}}}, {"tell", "#on-paper"}}});
    for (const Json& step : seen) EXPECT_EQ(step["error"], "");
    EXPECT_EQ(seen[1]["recipe"]["develop"]["crop"], "75,50,225,150");
    const auto expect_ruler = [&](const Json& told, const std::string& unit_name, double pixels) {
        ASSERT_GT(told.size(), 7U);  // the frame of the crop comes first, and the unit last
        EXPECT_EQ(told.back()["text"], unit_name);
        const Json& crop = told[0]["rect"];
        for (std::size_t i = 1; i + 1 < told.size(); ++i) {
            const double at = crop["x"].get<double>() +
                              std::stod(told[i]["text"].get<std::string>()) * pixels / 150 * crop["width"].get<double>();
            EXPECT_NEAR(told[i]["rect"]["x"].get<double>() + told[i]["rect"]["width"].get<double>() / 2, at, 1) << told[i];
        }
    };
    expect_ruler(seen[2]["told"], "px", 1);
    expect_ruler(seen[3]["told"], "mm", 10);  // 254 pixels an inch
    EXPECT_EQ(std::string(seen[7]["told"][0]["text"]).find("600 × 300 px, 6.0 × 3.0 cm"), 0U) << seen[7]["told"];
    const double width = seen[7]["recipe"]["develop"]["size"];
    EXPECT_NEAR(std::stod(seen[7]["recipe"]["develop"]["crop"].get<std::string>()) / width, 0.25, 0.005);
    EXPECT_NEAR(600 / width, 0.5, 0.005);
    make("latent-print", "a.latent", {"--recipe", write("r.json", seen[1]["recipe"].dump()), "-o", path("p.png")});
    EXPECT_EQ(image::decode_png(path("p.png")).format.width, 150);
}

// At 1:1, pixels of the print are those of the screen.
TEST_F(DarkroomPage, TheScreenShowsThePixelsOfThePrint) {
    const Json seen = drive({{{"set", {{"stops", "0.5"}}}},
                             {{"key", "1"}, {"shot", "one.png"}},
                             {{"key", "c"}},
                             {{"set", {{"stops", "1"}}}},
                             {{"key", "s"}},
                             {{"key", "1"}, {"shot", "both.png"}}});
    EXPECT_EQ(seen[5]["error"], "");
    // Pixels from (x0, 260) of the window on that are not those of the print.
    const auto different = [&](const std::string& name, int x0, const image::Decoded& print) {
        const image::Decoded shot = image::decode_png(path(name));
        const auto channels = static_cast<std::size_t>(shot.format.channels);
        int count = 0;
        for (int y = 0; y < 200; ++y) {
            for (int x = 0; x < 300; ++x) {
                const auto* a = shot.pixels.data() + static_cast<std::size_t>((y + 260) * shot.format.width + x + x0) * channels;
                count += std::equal(a, a + 3, print.pixels.data() + static_cast<std::size_t>(y * 300 + x) * 3) ? 0 : 1;
            }
        }
        return count;
    };
    const image::Decoded held = printed({"--stops", "0.5"}), other = printed({"--stops", "1"});
    EXPECT_EQ(different("seen/one.png", (936 - 300) / 2, held), 0);
    EXPECT_EQ(different("seen/both.png", (468 - 300) / 2, held), 0);
    EXPECT_EQ(different("seen/both.png", 468 + (468 - 300) / 2, other), 0);
}

TEST_F(DarkroomPage, MistakesAreSaidAndPrintsRecipesAndProbesWork) {
    const Json seen = drive({{{"set", {{"tone", "none"}}}},
                             {{"set", {{"contrast", "2"}}}},
                             {{"click", "undo"}},
                             {{"set", {{"size", "150"}}}},
                             {{"set", {{"crop", "10,20,140,90"}}}},
                             {{"set", {{"name", "dusk"}}}},
                             {{"click", "save"}},
                             {{"click", "print"}},
                             {{"click", "probe"}},
                             {{"at", {468, 360}}, {"shot", "crop.png"}},
                             {{"set", {{"probe-side", "16"}}}},
                             {{"set", {{"stops", "2"}}}, {"tell", "#plot"}}});
    EXPECT_EQ(seen[1]["error"], "--contrast and --black need a tone curve, but --tone is none");
    EXPECT_EQ(seen[2]["error"], "");
    Json jobs = get("api/prints");
    for (; jobs[0]["state"] == "running"; jobs = get("api/prints")) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(jobs[0]["state"], "done") << jobs;
    const image::Decoded print = image::decode_png(path("kept/dusk.png"));
    const image::Decoded expected = printed({"--recipe", path("kept/dusk.json")});
    EXPECT_EQ(print.format.width, 130);
    EXPECT_EQ(print.format.height, 70);
    EXPECT_EQ(print.pixels, expected.pixels);
    EXPECT_EQ(std::string(seen[9]["probed"]).find("pixel 75, 50: "), 0u) << seen[9]["probed"];
    EXPECT_EQ(std::string(seen[10]["probed"]).find("15.0 × 15.0 pixels from 75, 45: "), 0u) << seen[10]["probed"];
    EXPECT_NE(seen[11]["probed"], seen[10]["probed"]);  // brighter
    EXPECT_EQ(std::string(seen[11]["told"][0]["aria-label"]).find("Spectrum of the light, most at "), 0u) << seen[11]["told"];
}

}  // namespace
}  // namespace latent::testing
