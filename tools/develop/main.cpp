// latent-develop: records become pixels: linear XYZ, or a spectrum per pixel.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/cli.h"
#include "base/file.h"
#include "base/recipe_options.h"
#include "base/temporary_path.h"
#include "tools/develop/arguments.h"
#include "tools/develop/picture/oidn_picture.h"
#include "tools/develop/picture/picture.h"
#include "tools/develop/picture/report.h"

int main(int argc, char** argv) try {
    using namespace latent;

    develop::PictureOptions options;
    cli::CommonOptions common;
    bool dry_run = false;
    CLI::App app{"Develop raw samples into an EXR picture of linear XYZ pixels.", "latent-develop"};
    const CLI::App& decisions = develop::add_arguments(app, options);
    app.add_flag("--dry-run", dry_run,
                 "develop some runs and pixels, for up to two seconds of CPU time, then print the expected time, memory and file "
                 "size, and the "
                 "free space; needs no --output")
        ->excludes(app.get_option("--budget"));
    cli::add_common(app, common, true);
    app.parse_complete_callback([&] {
        const bool is_more = options.layers.any() || options.denoise > 0 || options.mipmap || options.zip || options.frames > 1;
        if (!options.for_oidn.empty() && is_more)
            throw CLI::ValidationError("--for-oidn",
                                       "does not go with --layers, --halves, --denoise, --mipmap, --compression or --frames");
        if (!options.for_oidn.empty()) options.output = develop::OidnPicture::colour_of(options.for_oidn);
        if (!options.output.empty()) return;
        if (!dry_run) throw CLI::RequiredError("--output or --for-oidn");
        options.output = "picture.exr";  // the free space is that of this folder
    });
    if (const auto done = cli::parse(app, argc, argv)) return *done;

    options.replace = common.force;
    options.memory = common.memory;
    options.threads = common.threads;
    const Result<std::string> recipe = recipe_text(cli::recipe_of(decisions));
    if (!recipe) return cli::fail(recipe.error());
    options.recipe = *recipe;

    remove_temporaries_on_signals();
    if (dry_run) {
        const Result<develop::Forecast> forecast = develop::forecast_picture(options);
        if (!forecast) return cli::fail(forecast.error());
        return cli::print_report(common.json ? develop::to_json(*forecast) : develop::to_text(*forecast), cli::kDone);
    }
    int status = cli::kDone;
    std::vector<std::string> reports;
    const std::vector<develop::PictureOptions> frames = develop::frames_of(options);
    for (const develop::PictureOptions& frame : frames) {  // all, before the first is written
        if (const Result<OutputFile> file = OutputFile::create(frame.output, frame.replace); !file) return cli::fail(file.error());
    }
    for (const develop::PictureOptions& frame : frames) {
        const Result<develop::PictureReport> report = develop::develop_picture(frame, cli::progress(common, "developing"));
        if (!report) return cli::fail(report.error());
        if (reports.empty())
            cli::tell(report->run_set.notes, report->warnings, develop::losses(*report));  // all frames have the same
        if (report->has_losses()) status = cli::kDoneWithLosses;
        reports.push_back(common.json ? develop::to_json(*report) : develop::to_text(*report));
    }
    const bool is_list = common.json && options.frames > 1;
    return cli::print_report(is_list ? fmt::format("[{}]\n", fmt::join(reports, ",")) : fmt::format("{}", fmt::join(reports, "")),
                             status);
} catch (...) {
    return latent::cli::fail_with_exception();
}
