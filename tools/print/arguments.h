// tools/print/arguments.h: the arguments of latent-print, and its --help.
#pragma once

#include "base/cli.h"
#include "tools/print/print.h"

namespace latent::print {

// The sections of a recipe.
struct Decisions {
    const CLI::App *picture, *print;
};

// Everything but what all tools take.
Decisions add_arguments(CLI::App& app, PrintOptions& options);

}  // namespace latent::print
