// base/help.h: how --help of every tool looks. For base/cli.h.
#pragma once

#include <CLI/CLI.hpp>

namespace latent::cli {

// Formats --help of `app` and of its commands: at most 80 columns, "--filter NAME", "--integrator path|bdpt",
// "--quality 1..100 [90]" with the default in brackets; then how values are written, and the app's footer.
void format_help(CLI::App& app);

}  // namespace latent::cli
