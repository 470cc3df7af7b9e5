// base/recipe_options.h: which options of a command line recipes hold (recipe.h): those of its sections, whose names are the keys.
// So a new option of a section is a new key.
#pragma once

#include <string>

#include "base/cli.h"
#include "base/recipe.h"

namespace latent::cli {

// Add the options of this section to what is returned. Of options of one name in two sections, the command line sets the first.
CLI::App& add_section(CLI::App& app, const std::string& name);

// --recipe: what the command line lacks comes from there. An option of the recipe gives way to one of the command line that
// excludes it. To be added to an app that has its sections.
void add_recipe(CLI::App& app);

// For the callback of an option, as --recipe is one: what the command line lacks comes from `recipe`, which errors call `place`.
// Throws CLI::ValidationError.
void apply_recipe(CLI::App& app, const std::string& place, const Recipe& recipe);

// What was given, by command line or recipe, in the order in which options were added; what is as by default is left out. Files
// lose their folders: no print says where anything was.
Recipe recipe_of(const CLI::App& section);

// JSON schema of recipes with these sections.
Recipe recipe_schema(const std::vector<const CLI::App*>& sections);

}  // namespace latent::cli
