// tools/darkroom/server/commands.h: the shell lines that make a print.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/recipe.h"

namespace latent::darkroom {

// As one word of a POSIX shell.
std::string quoted(const std::string& word);

// Writes the recipe to NAME.json and prints NAME.png.
std::string commands_for(const Recipe& recipe, const std::vector<std::filesystem::path>& inputs, const std::string& name);

}  // namespace latent::darkroom
