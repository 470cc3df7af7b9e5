// tools/convert/arguments.h: the arguments of latent-convert, and its --help.
#pragma once

#include "base/cli.h"
#include "tools/convert/options.h"

namespace latent::convert {

// What is decided about the print: the section "convert" of a recipe.
CLI::App& add_decisions(CLI::App& app, ConvertOptions& options);

// Where prints go, and what is said of them.
void add_outputs(CLI::App& app, ConvertOptions& options);

// Everything but what all tools take. Returns the section.
CLI::App& add_arguments(CLI::App& app, ConvertOptions& options);

}  // namespace latent::convert
