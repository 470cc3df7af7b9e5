// tools/develop/arguments.h: the arguments of latent-develop, and its --help.
#pragma once

#include "base/cli.h"
#include "tools/develop/picture/picture.h"

namespace latent::develop {

// Everything but what all tools take.
void add_arguments(CLI::App& app, PictureOptions& options);

// Of --fraction: above 0, at most 1. Errors: kUsage.
Result<double> parse_fraction(std::string_view text);

// Of --filter-factor: "none", "auto" (0) or a number above 0. Errors: kUsage.
Result<double> parse_filter_factor(std::string_view text);

}  // namespace latent::develop
