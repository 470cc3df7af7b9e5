// Recipes as the tools write and read them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "base/json.h"
#include "base/recipe.h"
#include "base/recipe_options.h"
#include "tests/print/samples.h"
#include "tools/convert/arguments.h"
#include "tools/develop/arguments.h"

namespace latent::testing {
namespace {

std::set<std::string> names_of(const CLI::App& app) {
    std::set<std::string> names;
    for (const CLI::Option* option : app.get_options()) names.insert(option->get_name());
    return names;
}

// A new option decides about the picture unless it is named here.
TEST(Recipes, HoldAllOptionsButThoseThatDecideNothingAboutThePicture) {
    develop::PictureOptions picture;
    convert::ConvertOptions print;
    CLI::App develop, convert;
    develop::add_arguments(develop, picture);
    convert::add_arguments(convert, print);
    // Files, reports, limits, and what is done where something is in the way.
    EXPECT_EQ(names_of(develop),
              (std::set<std::string>{"--help", "FILE", "--output", "--for-oidn", "--recipe", "--budget", "--simd", "--ignore-space",
                                     "--skip-duplicates", "--job", "--samples", "--list-films", "--list-observers"}));
    EXPECT_EQ(names_of(convert), (std::set<std::string>{"--help", "IMAGE", "--output", "--recipe", "--compare", "--gamut-report",
                                                        "--list-observers", "--list-papers", "--list-looks"}));
}

TEST(Recipes, ThePublishedSchemaIsThatOfTheTools) {
    develop::PictureOptions picture;
    convert::ConvertOptions print;
    CLI::App develop, convert;
    const std::string schema =
        json_text(cli::recipe_schema({&develop::add_decisions(develop, picture), &convert::add_decisions(convert, print)})) + "\n";
    std::ifstream file(in_tree("docs/recipe.schema.json"));
    const std::string published{std::istreambuf_iterator<char>(file), {}};
    if (schema == published) return;
    std::ofstream("recipe.schema.json") << schema;
    FAIL() << "docs/recipe.schema.json is not that of the options; the new one is in " << std::filesystem::current_path();
}

class Prints : public Samples {
 protected:
    static constexpr const char* kOutputs[] = {"p.png", "p.tif", "p.jpg", "p.exr", "p.dzi"};

    static Recipe recipe_in(const std::string& name) {
        const Result<Recipe> recipe = read_recipe(path(name));
        EXPECT_TRUE(recipe) << recipe.error().message;
        return recipe.value_or(Recipe());
    }
    static std::vector<std::string> outputs(const std::string& prefix) {
        std::vector<std::string> options;
        for (const char* name : kOutputs) options.insert(options.end(), {"-o", path(prefix + name)});
        return options;
    }
};

TEST_F(Prints, AreMadeAgainFromWhatTheySayOfThemselves) {
    struct Choice {
        std::vector<std::string> develop, convert;
    };
    const Choice choices[] = {
        {{}, {}},
        {{"--size", "150", "--filter", "mitchell", "--light", "lamp=2.5,6500K", "--light", "sky=0.2"},
         {"--stops", "1", "--tone", "filmic", "--contrast", "1.2", "--white", "A", "--quality", "95"}},
        {{"--size", "90", "--crop", "10,20,70,50", "--observer", "kodak_trix_400", "--lens-filter", "wratten-25",
          "--dim-fireflies"},
         {"--sensitivity", "2", "--crop", "12,22,60,48", "--gamut", "clip", "--no-dither", "--dpi", "72", "--tiles",
          "--png-tiles"}},
        {{"--size", "80"}, {"--exposure", "iso:400,time:1/60,f:2.8", "--stops", "-0.5"}},
        {{"--size", "60", "--film", "portra-400", "--push", "1"}, {"--look", "portrait", "--format", "6x7"}},
        {{"--size", "75", "--spectral-bins", "10", "--denoise", "--fraction", "0.5"}, {"--observer", "cie1964", "--key", "0.3"}},
    };
    for (const Choice& choice : choices) {
        ASSERT_NO_FATAL_FAILURE(make("latent-develop", "a.latent", with(choice.develop, {"-o", path("a.exr")})));
        ASSERT_NO_FATAL_FAILURE(make("latent-convert", "a.exr", with(choice.convert, outputs(""))));
        SCOPED_TRACE(recipe_in("p.png").dump());
        for (const char* print : kOutputs) {
            SCOPED_TRACE(print);
            ASSERT_NO_FATAL_FAILURE(make("latent-develop", "a.latent", {"--recipe", path(print), "-o", path("b.exr")}));
            EXPECT_EQ(bytes_of("a.exr"), bytes_of("b.exr"));
            ASSERT_NO_FATAL_FAILURE(make("latent-convert", "b.exr", with({"--recipe", path(print)}, outputs("again-"))));
            for (const std::string name : kOutputs) EXPECT_EQ(bytes_of(name), bytes_of("again-" + name)) << name;
        }
    }
}

TEST_F(Prints, HoldTheRecipeOfBothToolsAndNothingThatIsAsByDefault) {
    make("latent-develop", "a.latent", {"-o", path("a.exr"), "--size", "30", "--filter", "quartic:-3,1.5", "--memory", "512M"});
    make("latent-convert", "a.exr", with({"--key", "0.2", "--gamut", "luminance", "--threads", "1"}, outputs("")));
    for (const char* print : kOutputs)
        EXPECT_EQ(recipe_in(print).dump(), R"({"latent-recipe":1,"develop":{"size":30},"convert":{"key":0.2}})") << print;
}

TEST_F(Prints, OfSeveralExposuresKnowTheirOwn) {
    make("latent-develop", "a.latent", {"-o", path("a.exr"), "--size", "30"});
    make("latent-convert", "a.exr", {"--stops", "-1,0,0.5", "-o", path("s.png")});
    EXPECT_EQ(recipe_in("s-1.png")["convert"]["stops"], -1);
    EXPECT_FALSE(recipe_in("s+0.png").contains("convert"));
    make("latent-convert", "a.exr", {"--recipe", path("s+0.5.png"), "-o", path("again.png")});
    EXPECT_EQ(bytes_of("s+0.5.png"), bytes_of("again.png"));
}

TEST_F(Prints, NameFilesWithoutTheirFolders) {
    std::vector<std::string> rows;
    for (int nm = 400; nm <= 700; nm += 10) rows.push_back(fmt::format("{},{}\n", nm, nm - 390));
    write("eye.csv", "nm,v\n" + fmt::format("{}", fmt::join(rows, "")));
    make("latent-develop", "a.latent", {"-o", path("a.exr"), "--size", "30", "--observer", path("eye.csv")});
    EXPECT_EQ(recipe_in("a.exr")["develop"]["observer"], "eye.csv");
    EXPECT_EQ(bytes_of("a.exr").find(folder_->path().string()), std::string::npos);
}

TEST_F(Prints, APictureOfARecipeThatCannotBeReadIsPrintedWithAWarning) {
    make("latent-develop", "a.latent", {"-o", path("a.exr"), "--size", "30"});
    std::string bytes = bytes_of("a.exr");
    const std::size_t at = bytes.find("\"latent-recipe\":1");
    ASSERT_NE(at, std::string::npos);
    bytes[at + 16] = '7';
    write("a.exr", bytes);
    const Outcome outcome = use("latent-convert", "a.exr", {"-o", path("p.png")});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_NE(outcome.err.find("its recipe is left out: is a recipe of version 7"), std::string::npos) << outcome.err;
    EXPECT_EQ(recipe_in("p.png").dump(), R"({"latent-recipe":1})");
}

TEST_F(Prints, MistakesInARecipeAreMisuseAndLeaveNothing) {
    make("latent-develop", "a.latent", {"-o", path("a.exr"), "--size", "30"});
    const std::string recipe = write("r.json", R"({"latent-recipe": 1, "develop": {"fliter": "box"}, "convert": {"gamut": "x"}})");
    const Outcome develop = use("latent-develop", "a.latent", {"--recipe", recipe, "-o", path("no.exr")});
    EXPECT_EQ(develop.status, 2);
    EXPECT_EQ(develop.err,
              "latent-develop: --recipe: " + recipe + ": develop.fliter: unknown key; did you mean filter?; see --help\n");
    const Outcome convert = use("latent-convert", "a.exr", {"--recipe", recipe, "-o", path("no.png")});
    EXPECT_EQ(convert.status, 2);
    EXPECT_EQ(convert.err, "latent-convert: --recipe: " + recipe +
                               ": --gamut: unknown choice 'x'; choose from luminance, grey, clip; see --help\n");
    EXPECT_FALSE(std::filesystem::exists(path("no.exr")) || std::filesystem::exists(path("no.png")));
}

}  // namespace
}  // namespace latent::testing
