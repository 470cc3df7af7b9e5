#include "base/recipe.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/recipe_options.h"
#include "tests/faults/process.h"

namespace latent {
namespace {

std::string why_not(const std::string& text) {
    const Result<Recipe> recipe = parse_recipe(text);
    return recipe ? "" : recipe.error().message;
}

TEST(Recipe, TextIsReadBackAsItWas) {
    const std::string text =
        R"({"latent-recipe":1,"develop":{"size":2048,"light":["lamp=2.5","a \"\u00fc\" }=3"],"denoise":0.5},"convert":{"tiles":true}})";
    const Result<Recipe> recipe = parse_recipe(text);
    ASSERT_TRUE(recipe) << recipe.error().message;
    EXPECT_EQ(*recipe_text(*recipe), text);
}

TEST(Recipe, SectionsAndBlanksMayStandInAnyOrder) {
    const Result<Recipe> a = parse_recipe("\n{ \"convert\": {\"key\": 0.2},\n \"latent-recipe\" : 1, \"develop\": {} }");
    ASSERT_TRUE(a) << a.error().message;
    EXPECT_EQ(*recipe_text(*a), R"({"latent-recipe":1,"convert":{"key":0.2}})");
}

TEST(Recipe, WhatIsWrongIsNamed) {
    EXPECT_EQ(why_not("[1]"), "is not a JSON object");
    EXPECT_EQ(why_not("{\"latent-recipe\": 1"), "is not valid JSON");
    EXPECT_EQ(why_not("{\"develop\": {}}"), "is no recipe; it must begin with \"latent-recipe\": 1");
    EXPECT_EQ(why_not("{\"latent-recipe\": 2}"), "is a recipe of version 2; this program reads version 1");
    EXPECT_EQ(why_not("{\"latent-recipe\": \"1\"}"), "is a recipe of version \"1\"; this program reads version 1");
    EXPECT_EQ(why_not(R"({"latent-recipe":1,"devlop":{}})"), "devlop: recipes have no such section; did you mean develop?");
    EXPECT_EQ(why_not(R"({"latent-recipe":1,"develop":3})"), "develop: must be an object, {...}");
    EXPECT_EQ(why_not(R"({"latent-recipe":1,"develop":{"size":1,"crop":2,"size":1}})"), "size: given twice");
    for (const char* value : {"null", "{}", "[true]", "[null]"}) {
        EXPECT_EQ(why_not(R"({"latent-recipe":1,"develop":{"size":)" + std::string(value) + "}}"),
                  "develop.size: must be a text, a number, true, false, or a list of texts and numbers");
    }
    EXPECT_EQ(why_not(R"({"latent-recipe":1,"develop":{"size":[[[1]]]}})"), "is nested more than 3 levels deep");
    EXPECT_EQ(why_not(R"({"latent-recipe":1,"develop":{"size":1e999}})"), "is not valid JSON");
    EXPECT_EQ(why_not(std::string(kLongestRecipe, ' ') + "{}"), "too long for a recipe: more than 60000 bytes");
}

class RecipeFile : public ::testing::Test {
 protected:
    std::string write(const std::string& bytes) {
        const std::string path = (folder_ / "print.tif").string();
        std::ofstream(path, std::ios::binary) << bytes;
        return path;
    }
    testing::TemporaryFolder folder_;
};

// Of all places around the border between two pieces in which files are read.
TEST_F(RecipeFile, ARecipeIsFoundWhereverItStands) {
    const std::string text = R"({"latent-recipe":1,"develop":{"light":["a}=2"]}})";
    constexpr std::size_t kPiece = 1 << 20;
    for (const std::size_t at : {std::size_t{1}, kPiece - text.size(), kPiece - 16, kPiece - 1, kPiece, 2 * kPiece - 3}) {
        for (const std::string& behind : {std::string(), std::string("}, \"x\": {}\xff"), std::string(kPiece, '}')}) {
            const Result<Recipe> found = read_recipe(write(std::string(at, '\1') + text + behind));
            ASSERT_TRUE(found) << at << ": " << found.error().message;
            EXPECT_EQ(*recipe_text(*found), text);
        }
    }
    EXPECT_EQ(read_recipe(write("no")).error().message, (folder_ / "print.tif").string() + ": holds no recipe");
    EXPECT_EQ(read_recipe(write("")).error().message, (folder_ / "print.tif").string() + ": holds no recipe");
}

TEST_F(RecipeFile, ALargeFileIsRefusedUnread) {
    EXPECT_EQ(read_recipe(write("{" + std::string(50'000'000, ' '))).error().message,
              (folder_ / "print.tif").string() + ": too large for a recipe");
}

// A tool with an option of each kind.
struct Tool {
    CLI::App app{"", "tool"};
    CLI::App& section = cli::add_section(app, "develop");
    std::vector<std::string> lights;
    std::string tone = "film", table, film;
    double key = 0.5, denoise = 0, budget = 0;
    int dpi = 300;
    std::uint64_t size = 0;
    bool tiles = false, balance = true;

    Tool() {
        section.add_option("--light", lights)->allow_extra_args(false);
        section.add_option("--tone", tone)->check(CLI::IsMember({"film", "linear", "8"}))->capture_default_str();
        section.add_option("--table", table)->type_name("NAME|FILE.csv");
        section.add_option("--film", film)->type_name("NAME|FOLDER/NAME");
        auto* number = cli::add_number(section, "-k,--key", key, "", 0, 1);
        cli::add_count(section, "--size", size, "");
        section.add_flag("--denoise{1}", denoise);
        section.add_flag("--tiles", tiles);
        section.add_flag("--balance,!--no-balance", balance);
        auto* other = cli::add_count(section, "--dpi", dpi, "", 1, 600)->excludes(number);
        section.add_flag("--needs-dpi")->needs(other);
        cli::add_number(app, "--budget", budget, "", 0, 9)->excludes(section.get_option("--tiles"));
        cli::add_recipe(app);
    }
    std::string run(std::vector<std::string> arguments) {
        std::ranges::reverse(arguments);  // as CLI11 takes them
        try {
            app.parse(arguments);
        } catch (const CLI::ParseError& error) {
            return cli::in_plain_words(error);
        }
        return *recipe_text(cli::recipe_of(section));
    }
};

class RecipeOptions : public RecipeFile {
 protected:
    std::string recipe(const std::string& develop) { return write(R"({"latent-recipe": 1, "develop": {)" + develop + "}}"); }
    std::string develop(const std::string& text) { return R"({"latent-recipe":1,"develop":{)" + text + "}}"; }
};

TEST_F(RecipeOptions, HoldWhatDiffersFromTheDefaultsInTheOrderOfTheOptions) {
    EXPECT_EQ(Tool().run({}), R"({"latent-recipe":1})");
    EXPECT_EQ(Tool().run({"--tone", "film", "--key", "0.5", "--tiles=false"}), R"({"latent-recipe":1})");
    const std::string all = develop(
        R"("light":["a=1","b=2"],"tone":"linear","table":"x.csv","film":"mine/x","key":0.25,"size":2048,"denoise":1,"tiles":true,"balance":false)");
    EXPECT_EQ(Tool().run({"--light", "a=1", "--tone", "linear", "--table", "/h/t/x.csv", "--film", "/h/films/mine/x", "-k", "0.25",
                          "--size", "2048", "--light", "b=2", "--denoise", "--tiles", "--no-balance"}),
              all);
    EXPECT_EQ(Tool().run({"--no-balance", "--tiles", "--denoise", "--light", "a=1", "--size", "2048", "--key=0.25", "--film",
                          "mine/x", "--light", "b=2", "--table", "x.csv", "--tone", "linear"}),
              all);
}

TEST_F(RecipeOptions, ARecipeGivesTheSameRecipe) {
    for (const char* text : {R"("light":["a=1","b=2"],"key":0.25,"size":2048,"denoise":0.5,"tiles":true,"balance":false)",
                             R"("tone":8)", R"("balance":true,"dpi":72,"needs-dpi":true)", R"("size":"2K")"}) {
        EXPECT_EQ(Tool().run({"--recipe", recipe(text)}), develop(text));
    }
    EXPECT_EQ(Tool().run({"--recipe", recipe(R"("tiles": false, "light": "a=1", "tone": "film")")}), develop(R"("light":["a=1"])"));
    EXPECT_EQ(Tool().run({"--recipe", recipe(R"("light": [])")}), R"({"latent-recipe":1})");
}

TEST_F(RecipeOptions, TheCommandLineWins) {
    const std::string file = recipe(R"("key": 0.25, "tiles": true, "light": ["a=1"], "size": 7)");
    EXPECT_EQ(Tool().run({"--recipe", file, "--key", "0.75", "--light", "b=2", "--tiles=false"}),
              develop(R"("light":["b=2"],"key":0.75,"size":7)"));
    EXPECT_EQ(Tool().run({"--size", "8", "--recipe", file}), develop(R"("light":["a=1"],"key":0.25,"size":8,"tiles":true)"));
}

TEST_F(RecipeOptions, WhatTheCommandLineExcludesGivesWayWithWhatNeedsIt) {
    const std::string file = recipe(R"("dpi": 72, "needs-dpi": true, "tiles": true)");
    EXPECT_EQ(Tool().run({"--recipe", file, "--key", "0.75"}), develop(R"("key":0.75,"tiles":true)"));
    EXPECT_EQ(Tool().run({"--recipe", file, "--budget", "1"}), develop(R"("dpi":72,"needs-dpi":true)"));
    EXPECT_EQ(Tool().run({"--recipe", recipe(R"("dpi": 72, "key": 0.75)")}), "--key excludes --dpi");
}

TEST_F(RecipeOptions, AMistakeIsOneLineThatNamesThePlace) {
    const auto line = [&](const std::string& text) {
        const std::string said = Tool().run({"--recipe", recipe(text)}),
                          place = "--recipe: " + (folder_ / "print.tif").string() + ": ";
        EXPECT_EQ(said.substr(0, place.size()), place) << said;
        return said.substr(std::min(said.size(), place.size()));
    };
    EXPECT_EQ(line(R"("tonne": "film")"), "develop.tonne: unknown key; did you mean tone?");
    EXPECT_EQ(line(R"("budget": 3)"), "develop.budget: unknown key");
    EXPECT_EQ(line(R"("key": true)"), "develop.key: must be a text or a number");
    EXPECT_EQ(line(R"("key": [1])"), "develop.key: must be a text or a number");
    EXPECT_EQ(line(R"("tiles": 1)"), "develop.tiles: must be true or false");
    EXPECT_EQ(line(R"("denoise": "1")"), "develop.denoise: must be true, false or a number");
    EXPECT_EQ(line(R"("light": false)"), "develop.light: must be a text, or a list of texts");
    EXPECT_EQ(line(R"("tone": "x")"), "--tone: unknown choice 'x'; choose from film, linear, 8");
    EXPECT_EQ(line(R"("key": 7)"), "--key: '7' is not from 0 to 1");
}

// The schema lets through what the tool takes, as far as schemas can.
TEST_F(RecipeOptions, ASchemaDescribesEachKey) {
    Tool tool;
    const Recipe schema = cli::recipe_schema({&tool.section});
    const Recipe& keys = schema["properties"]["develop"]["properties"];
    EXPECT_EQ(keys.size(), tool.section.get_options().size());
    EXPECT_EQ(keys["tone"]["enum"].dump(), R"(["film","linear","8",8])");
    EXPECT_EQ(keys["tone"]["default"], "film");
    EXPECT_EQ(keys["tiles"]["type"], "boolean");
    EXPECT_EQ(keys["denoise"]["type"].dump(), R"(["boolean","number"])");
    EXPECT_EQ(keys["light"]["anyOf"][1]["type"], "array");
    EXPECT_EQ(keys["key"]["default"], 0.5);
    EXPECT_EQ(schema["additionalProperties"], false);
}

}  // namespace
}  // namespace latent
