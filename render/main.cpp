// latent-render: a scene -> one part of raw samples. docs/rendering.md.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/cli.h"
#include "base/parallel.h"
#include "base/simd.h"
#include "base/terminal.h"
#include "render/load/list_features.h"
#include "render/program/arguments.h"
#include "render/program/help.h"
#include "render/program/loop.h"
#include "render/program/report.h"
#include "render/program/stop_signals.h"

int main(int argc, char** argv) try {
    using namespace latent;
    using namespace latent::render;

    RenderSettings settings;
    RenderOptions options;
    cli::CommonOptions common;
    bool dry_run = false, ignore_space = false;

    CLI::App app{"Render a pbrt-v4, glTF or OBJ scene into a .latent file of raw samples.", "latent-render"};
    app.add_option("SCENE", settings.scene, "scene file (.pbrt, .gltf, .glb, .obj)")->required();
    app.add_option("-o,--output", options.output, "file to write: one part of the job")->required()->check(cli::ends_in(".latent"));
    auto* spp = cli::add_positive_number(app, "--spp", settings.spp, "samples per pixel, at --resolution");
    cli::add_parsed(app, "--samples", settings.samples, parse_samples, "samples A to B-1, instead of --spp")
        ->excludes(spp)
        ->type_name("A:B");
    app.add_option("--more-than", settings.more_than, "render only the samples of --spp that follow those in these files")
        ->excludes("--samples")
        ->type_name("FILE...");
    cli::add_parsed(app, "--shard", settings.shard, parse_shard, "shard to render, out of N; I is 0 to N-1")->type_name("I/N");
    cli::add_parsed(app, "--resolution", settings.resolution, parse_resolution,
                    "image size, used only to count samples for --spp (default: the scene's); samples have no pixels")
        ->type_name("WxH");
    cli::add_choice<std::optional<IntegratorKind>>(app, "--integrator", settings.integrator,
                                                   {{"path", IntegratorKind::kPath}, {"bdpt", IntegratorKind::kBdpt}},
                                                   "path tracing or bidirectional path tracing (default: the scene's)");
    cli::add_choice<Connections>(app, "--connections", settings.connections,
                                 {{"one", Connections::kOne}, {"all", Connections::kAll}},
                                 "connections that bdpt makes for each path length: one at random, or all");
    cli::add_parsed(app, "--max-depth", settings.max_depth, parse_depth,
                    "maximum number of scattering vertices per path (default: the scene's)")
        ->type_name("N|unlimited");
    using sampledb::RecordKind;
    cli::add_choice<RecordKind>(app, "--record", settings.record, {{"spectral", RecordKind::kSpectral}, {"xyz", RecordKind::kXyz}},
                                "contents of a record: a value for each wavelength, or XYZ only");
    cli::add_count(app, "--wavelengths", settings.wavelengths, "wavelengths per sample", 4u, 32u);
    app.add_flag("--light-groups", settings.light_groups, "keep lights of different names apart, for latent-develop --light");
    cli::add_count(app, "--precision", settings.precision,
                   "mantissa bits of each stored value; 23 keeps all, fewer are rounded without bias", 1u, 23u);
    cli::add_count(app, "--seed", settings.seed, "random seed; each seed is a separate job with independent samples");
    cli::add_count(app, "--run-samples", settings.run_samples,
                   "samples per run, the unit of storage; a power of two (default: runs of about 64 MiB)", 1024u, 4194304u);
    cli::add_duration(app, "--checkpoint", options.checkpoint_seconds, "interval at which finished work is committed to disk")
        ->default_str("60s");
    cli::add_duration(app, "--max-time", options.max_seconds,
                      "time limit; the render stops with exit status 75 and can be resumed");
    cli::add_size(app, "--texture-cache", settings.texture_cache, "memory limit for decoded textures")->default_str("256M");
    app.add_option("--simd", settings.simd,
                   "instruction set for ray tracing; best is the fastest available up to avx2. Samples are bit-identical only with "
                   "the same set")
        ->capture_default_str()
        ->type_name(fmt::format("best|{}", fmt::join(simd_levels(), "|")));
    app.add_flag("--dry-run", dry_run,
                 "render for two seconds (or --max-time), then print the expected time and file size, and the free space");
    app.add_flag("--strict", settings.strict, "treat ignored scene features as errors instead of warnings");
    app.add_flag_callback(
        "--list-features", [] { cli::print(list_features()), throw CLI::Success(); },
        "list the supported scene features, and exit");
    app.add_flag("--ignore-space", ignore_space, "start even if the file is not expected to fit on the disk");
    cli::add_common(app, common, false);
    app.footer(kBelowOptions);
    if (const auto done = cli::parse(app, argc, argv)) return *done;

    options.force = common.force;
    settings.output = options.output;
    listen_to_signals(cli::kStopped);
    const Threads threads(common.threads);
    options.threads = threads.count();
    Result<std::unique_ptr<RenderJob>> job = Error{};
    threads.run([&] { job = prepare(settings); });
    if (!job) return cli::fail(job.error());
    for (const std::string& warning : (*job)->warnings) cli::warn(warning);
    options.provenance_json = provenance(**job, settings);
    const std::atomic<bool>& stop_requested = commit_on_signals();
    if (dry_run) {
        const Result<Forecast> expected = forecast(**job, options, trial_seconds(options), stop_requested);
        if (!expected) return cli::fail(expected.error());
        if (!expected->fits()) cli::warn(too_large(*expected, options.output));
        cli::print(to_text(*expected, **job, common.json));
        return cli::kDone;
    }
    if (!ignore_space) {
        if (const Status fits = check_space(**job, options, stop_requested); !fits) return cli::fail(fits.error());
    }
    if (!cli::stderr_is_terminal() && !common.quiet) options.log = cli::log_line;
    // The bar is gone before the report: it lives as long as this expression.
    const Result<RenderReport> report =
        render::render(**job, options, stop_requested, options.log ? Progress() : cli::progress(common, "rendering"));
    if (!report) return cli::fail(report.error());
    if (report->faults.total() > 0) cli::warn(to_text(report->faults));
    const int status = cli::print_report(to_text(*report, **job, common.json), cli::kDone);
    if (report->complete) return status;
    return cli::fail(
        {ErrorCode::kStopped, fmt::format("interrupted: {} of {} samples are committed; run the same command again to resume",
                                          report->committed, (*job)->range.size())});
} catch (...) {
    return latent::cli::fail_with_exception();
}
