// tools/inspect/arguments.h: the options of the commands that have many.
#pragma once

#include <CLI/CLI.hpp>

#include "tools/inspect/cat.h"
#include "tools/inspect/gen.h"
#include "tools/inspect/noise.h"

namespace latent::inspect {

void add_cat_options(CLI::App& cat, CatOptions& options);
void add_noise_options(CLI::App& noise, NoiseOptions& options);
void add_gen_options(CLI::App& gen, GenOptions& options);

}  // namespace latent::inspect
