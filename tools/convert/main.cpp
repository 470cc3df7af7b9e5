// latent-convert: from developed pixels to a print.
#include "base/cli.h"
#include "base/recipe_options.h"
#include "base/temporary_path.h"
#include "tools/convert/arguments.h"
#include "tools/convert/convert.h"
#include "tools/convert/report.h"

int main(int argc, char** argv) try {
    namespace cli = latent::cli;
    latent::convert::ConvertOptions options;
    cli::CommonOptions common;
    CLI::App app{"Turn a developed picture of any size into a print for a display.", "latent-convert"};
    const CLI::App& decisions = latent::convert::add_arguments(app, options);
    cli::add_common(app, common, true);
    if (const auto done = cli::parse(app, argc, argv)) return *done;
    options.threads = common.threads;
    options.memory = common.memory;
    options.replace = common.force;
    const auto recipe = latent::recipe_text(cli::recipe_of(decisions));
    if (!recipe) return cli::fail(recipe.error());
    options.recipe = *recipe;
    latent::remove_temporaries_on_signals();
    const auto report = latent::convert::convert(options, cli::progress(common, "printing"));
    if (!report) return cli::fail(report.error());
    cli::tell(report->notes, report->warnings, latent::convert::losses(*report));
    return cli::print_report(common.json ? latent::convert::to_json(*report) : latent::convert::to_text(*report),
                             report->damaged() > 0 ? cli::kDoneWithLosses : cli::kDone);
} catch (...) {
    return latent::cli::fail_with_exception();
}
