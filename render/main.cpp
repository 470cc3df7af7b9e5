// latent-render: a scene -> one part of raw samples. docs/rendering.md.
#include <fmt/format.h>

#include "base/cli.h"
#include "base/parallel.h"
#include "base/terminal.h"
#include "render/preview/preview.h"
#include "render/program/command_line.h"
#include "render/program/forecast.h"
#include "render/program/loop.h"
#include "render/program/report.h"
#include "render/program/stop_signals.h"
#include "render/target/until_noise.h"

namespace {

void warn_of_files(const latent::render::RenderJob& job) {
    for (const std::string& warning : latent::render::later_warnings(job)) latent::cli::warn(warning);
}

latent::Error interrupted(const latent::render::RenderReport& report, const latent::render::RenderJob& job) {
    return {latent::ErrorCode::kStopped,
            fmt::format("interrupted: {} of {} samples are committed; run the same command again to resume", report.committed,
                        job.range.size())};
}

}  // namespace

int main(int argc, char** argv) try {
    using namespace latent;
    using namespace latent::render;

    CommandLine line;
    cli::CommonOptions common;
    CLI::App app{"Render a pbrt-v4, glTF or OBJ scene into a .latent file of raw samples.", "latent-render"};
    add_arguments(app, line);
    cli::add_common(app, common, false);
    if (const auto done = cli::parse(app, argc, argv)) return *done;

    RenderSettings& settings = line.settings;
    RenderOptions& options = line.options;
    options.force = common.force;
    settings.output = options.output;
    if (const Status folder = check_folder(options.output); !folder) return cli::fail(folder.error());
    listen_to_signals(cli::kStopped);
    const Threads threads(common.threads);
    options.threads = threads.count();
    Result<std::unique_ptr<RenderJob>> job = Error{};
    threads.run([&] { job = prepare(settings); });
    if (!job) return cli::fail(job.error());
    for (const std::string& added : (*job)->scene.added) cli::note(added);
    for (const std::string& warning : (*job)->warnings) cli::warn(warning);
    auto missing = sampledb::PartWriter::find_missing(part_options(**job, options), (*job)->job);
    if (!missing && missing.error().code == ErrorCode::kMismatch && (line.dry_run || line.preview_seconds > 0)) {
        cli::note(options.output.string() + ": holds the samples of another job, and stays as it is");
        options.force = true;  // as if it were not there: nothing is written to it
        missing = sampledb::PartWriter::find_missing(part_options(**job, options), (*job)->job);
    }
    if (!missing) return cli::fail(missing.error());
    options.provenance_json = provenance(**job, settings, (*job)->range.size() - missing->size());
    const std::atomic<bool>& stop_requested = commit_on_signals();
    if (line.dry_run) {
        if (const Status writable = line.has_output && !missing->empty() ? check_writable(options.output) : Status{}; !writable)
            return cli::fail(writable.error());
        const Result<Forecast> expected = forecast(**job, options, trial_seconds(options), kMaxTrials, stop_requested);
        if (!expected) return cli::fail(expected.error());
        warn_of_files(**job);
        if (!expected->fits()) cli::warn(too_large(*expected, options.output));
        cli::print(to_text(*expected, **job, common.json));
        return cli::kDone;
    }
    if (line.preview_seconds > 0) {
        const Result<Preview> shown = preview(**job, options, line.preview_seconds, !line.keep_noise, stop_requested);
        if (!shown) return cli::fail(shown.error());
        warn_of_files(**job);
        if (!shown->forecast.fits()) cli::warn(too_large(shown->forecast, options.output));
        cli::print(to_text(*shown, **job, common.json));
        return cli::kDone;
    }
    if (!cli::stderr_is_terminal() && !common.quiet) options.log = cli::log_line;
    // The bar is gone before the report: it lives as long as the expression that it is handed to.
    const auto progress = [&] { return options.log ? Progress() : cli::progress(common, "rendering"); };
    if (line.until) {
        const Result<UntilNoiseReport> report =
            render_until(**job, settings, options, *line.until, line.ignore_space, stop_requested, progress());
        if (!report) return cli::fail(report.error());
        if (report->render.faults.total() > 0) cli::warn(to_text(report->render.faults));
        warn_of_files(**job);
        const int status = cli::print_report(to_text(*report, *line.until, **job, common.json), cli::kDone);
        if (!report->noise) return cli::fail(interrupted(report->render, **job));
        if (!report->shortfall.empty()) cli::warn(report->shortfall);
        return status;
    }
    if (!line.ignore_space) {
        if (const Status fits = check_space(**job, options, stop_requested); !fits) return cli::fail(fits.error());
    }
    const Result<RenderReport> report = render::render(**job, options, stop_requested, progress());
    if (!report) return cli::fail(report.error());
    if (report->faults.total() > 0) cli::warn(to_text(report->faults));
    warn_of_files(**job);
    const int status = cli::print_report(to_text(*report, **job, common.json), cli::kDone);
    return report->complete ? status : cli::fail(interrupted(*report, **job));
} catch (...) {
    return latent::cli::fail_with_exception();
}
