// latent-print: from samples to prints.
#include <fmt/format.h>

#include "base/cli.h"
#include "base/recipe_options.h"
#include "base/temporary_path.h"
#include "tools/convert/report.h"
#include "tools/develop/picture/report.h"
#include "tools/print/arguments.h"

int main(int argc, char** argv) try {
    using namespace latent;

    print::PrintOptions options;
    cli::CommonOptions common;
    CLI::App app{"Print samples: develop and convert them in one command.", "latent-print"};
    const print::Decisions decisions = print::add_arguments(app, options);
    cli::add_common(app, common, true);
    if (const auto done = cli::parse(app, argc, argv)) return *done;

    const Result<std::string> of_picture = recipe_text(cli::recipe_of(*decisions.picture));
    const Result<std::string> of_print = recipe_text(cli::recipe_of(*decisions.print));
    if (!of_picture || !of_print) return cli::fail(of_picture ? of_print.error() : of_picture.error());
    options.picture.recipe = *of_picture;
    options.print.recipe = *of_print;
    options.picture.threads = options.print.threads = common.threads;
    options.picture.memory = options.print.memory = common.memory;
    options.print.replace = common.force;

    remove_temporaries_on_signals();
    const Result<print::PrintReport> report =
        print::print(options, cli::progress(common, "developing"), cli::progress(common, "printing"));
    if (!report) return cli::fail(report.error());
    cli::tell(report->picture.run_set.notes, report->picture.warnings, develop::losses(report->picture));
    cli::tell(report->print.notes, report->print.warnings, convert::losses(report->print));
    const bool has_losses = report->picture.has_losses() || report->print.damaged() > 0;
    const std::string text = common.json ? fmt::format("{{\"develop\": {}, \"convert\": {}}}\n", develop::to_json(report->picture),
                                                       convert::to_json(report->print))
                                         : develop::to_text(report->picture) + convert::to_text(report->print);
    return cli::print_report(text, has_losses ? cli::kDoneWithLosses : cli::kDone);
} catch (...) {
    return latent::cli::fail_with_exception();
}
