// Recipes, in files and inside prints, and what they set in the tools.
#include "base/recipe.h"
#include "base/recipe_options.h"
#include "tests/fuzz/target.h"
#include "tools/convert/arguments.h"
#include "tools/develop/arguments.h"

namespace latent::fuzz {

namespace {

// What both tools make of the recipe, as a recipe; "" if they refuse it.
std::string taken_by_tools(const std::filesystem::path& recipe) {
    develop::PictureOptions picture;
    convert::ConvertOptions print;
    CLI::App app;
    const CLI::App& develop = develop::add_decisions(app, picture);
    const CLI::App& convert = convert::add_decisions(app, print);
    cli::add_recipe(app);
    try {
        app.parse(std::vector<std::string>{recipe.string(), "--recipe"});
    } catch (const CLI::ParseError&) {
        return "";
    }
    Recipe both = cli::recipe_of(develop);
    both.update(cli::recipe_of(convert));
    return *recipe_text(both);
}

bool run_recipe(ByteSpan bytes) {
    const std::filesystem::path path = as_file("a.json", bytes);
    const Result<Recipe> recipe = read_recipe(path);
    if (!recipe) return false;
    const std::string text = *recipe_text(*recipe);
    const Result<Recipe> again = parse_recipe(text);
    require(again && *recipe_text(*again) == text, "a recipe is read back as it was written");
    const std::string taken = taken_by_tools(path);
    if (taken.empty()) return false;
    const auto written = std::as_bytes(std::span(taken));
    require(taken_by_tools(as_file("b.json", written)) == taken, "what tools make of a recipe is what they make of that");
    return true;
}

}  // namespace

Target recipe() { return {"recipe", run_recipe, nullptr, true, 4000, nullptr}; }

}  // namespace latent::fuzz
