#include "tools/print/arguments.h"

#include "base/recipe_options.h"
#include "tools/convert/arguments.h"
#include "tools/develop/arguments.h"

namespace latent::print {

namespace {

constexpr const char* kHelp = R"(
latent-print does what latent-develop and latent-convert do in a row: the same
prints, byte for byte, without a picture file in between. Their --help explains
the values of options. Of options that both have (--observer, --film, --crop,
--compression), the command line sets those of latent-develop; a recipe sets
those of either.

Examples:
  latent-print night.latent -o night.png
      a print of the size that was rendered for
  latent-print night.latent -o night.png --size 2048 --stops 1 --light lamp=2
      larger, one stop brighter, with twice the light of the lamp
  latent-print parts/ --recipe evening.json -o print.tif -o wall.dzi
      as a recipe says, into two files
  latent-print night.latent --recipe print.tif -o again.tif
      a print again, bit for bit, from what it says of itself

Exit status: 0 done; 1 failed, no output; 2 wrong usage; 3 done, but damaged,
foreign, missing or non-finite input was left out, or the report could not be
written.)";

}  // namespace

Decisions add_arguments(CLI::App& app, PrintOptions& options) {
    app.footer(kHelp);
    develop::add_inputs(app, options.picture);
    convert::add_outputs(app, options.print);
    const CLI::App& picture = develop::add_decisions(app, options.picture);
    const CLI::App& print = convert::add_decisions(app, options.print);
    cli::add_recipe(app);
    return {&picture, &print};
}

}  // namespace latent::print
