// base/recipe.h: recipes: what command lines have decided about a picture, as one JSON object. docs/recipes.md.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "base/result.h"

namespace latent {

inline constexpr int kRecipeVersion = 1;
inline constexpr std::size_t kLongestRecipe = 60000;  // bytes; the comment of a JPEG holds no more than 65533

// One section for each tool, in the order in which light passes through them.
inline constexpr std::string_view kRecipeSections[] = {"develop", "convert"};

// {"latent-recipe": 1, "develop": {"size": 2048, "light": ["lamp=2.5", "sky=0.3"]}, "convert": {"tiles": true}}: sections, whose
// values are texts, numbers, true or false, and lists of texts and numbers.
using Recipe = nlohmann::ordered_json;

// Errors: kUsage, saying what is wrong, but not where: too long, no such JSON, another version, an unknown section, another kind of
// value, a name given twice.
Result<Recipe> parse_recipe(std::string_view text);

// The recipe that the file is, or that is somewhere inside: whatever the format of a print, its recipe stands there as recipe_text
// wrote it. Errors: of reading; kUsage, naming the file.
Result<Recipe> read_recipe(const std::filesystem::path& path);

// One line of printable ASCII, sections in their order, none empty. Errors: kUsage if it is too long.
Result<std::string> recipe_text(const Recipe& recipe);

}  // namespace latent
