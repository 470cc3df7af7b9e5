// tools/inspect/arguments.h: the options of the two commands that have many.
#pragma once

#include <CLI/CLI.hpp>

#include "tools/inspect/cat.h"
#include "tools/inspect/gen.h"

namespace latent::inspect {

void add_cat_options(CLI::App& cat, CatOptions& options);
void add_gen_options(CLI::App& gen, GenOptions& options);

}  // namespace latent::inspect
