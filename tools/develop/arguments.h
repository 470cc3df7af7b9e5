// tools/develop/arguments.h: the arguments of latent-develop, and its --help.
#pragma once

#include "base/cli.h"
#include "tools/develop/picture/picture.h"

namespace latent::develop {

// What is decided about the picture: the section "develop" of a recipe.
CLI::App& add_decisions(CLI::App& app, PictureOptions& options);

// Which samples are read, and whether the work begins though its disk may be too small.
void add_inputs(CLI::App& app, PictureOptions& options);

// Everything but what all tools take. Returns the section.
CLI::App& add_arguments(CLI::App& app, PictureOptions& options);

// Parses --fraction: above 0, at most 1. Errors: kUsage.
Result<double> parse_fraction(std::string_view text);

// Parses --filter-factor: "none", "auto" (0) or a number above 0. Errors: kUsage.
Result<double> parse_filter_factor(std::string_view text);

}  // namespace latent::develop
