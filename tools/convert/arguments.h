// tools/convert/arguments.h: the arguments of latent-convert, and its --help.
#pragma once

#include "base/cli.h"
#include "tools/convert/options.h"

namespace latent::convert {

// Everything but what all tools take.
void add_arguments(CLI::App& app, ConvertOptions& options);

}  // namespace latent::convert
