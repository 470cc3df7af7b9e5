// latent-render: a pbrt-v4 scene -> one part of raw samples. docs/rendering.md.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/cli.h"
#include "base/parallel.h"
#include "base/simd.h"
#include "render/program/arguments.h"
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

    CLI::App app{"Renders samples of a pbrt-v4 scene into one .latent part. The same command again goes on where it stopped.",
                 "latent-render"};
    app.add_option("SCENE", settings.scene, "the scene, a .pbrt file")->required();
    app.add_option("-o,--output", options.output, "the part to write")->required()->check(cli::ends_in(".latent"));
    auto* spp = cli::add_positive_number(app, "--spp", settings.spp, "samples per pixel of --resolution, or of the scene's film");
    cli::add_parsed(app, "--samples", settings.samples, parse_samples, "instead, sample numbers A .. B-1; A begins a run")
        ->excludes(spp)
        ->type_name("A:B");
    cli::add_parsed(app, "--shard", settings.shard, parse_shard, "only the I-th of N parts of the samples, I = 0..N-1")
        ->type_name("I/N");
    cli::add_parsed(app, "--resolution", settings.resolution, parse_resolution,
                    "pixels that --spp counts; samples themselves have no pixels")
        ->type_name("WxH");
    cli::add_choice<std::optional<IntegratorKind>>(app, "--integrator", settings.integrator,
                                                   {{"path", IntegratorKind::kPath}, {"bdpt", IntegratorKind::kBdpt}},
                                                   "instead of the scene's");
    cli::add_choice<Connections>(app, "--connections", settings.connections,
                                 {{"one", Connections::kOne}, {"all", Connections::kAll}},
                                 "bdpt: of each path length, one random connection or all");
    cli::add_parsed(app, "--max-depth", settings.max_depth, parse_depth, "scattering vertices of a path, instead of the scene's")
        ->type_name("N|unlimited");
    using sampledb::RecordKind;
    cli::add_choice<RecordKind>(app, "--record", settings.record, {{"spectral", RecordKind::kSpectral}, {"xyz", RecordKind::kXyz}},
                                "what a record stores: its wavelengths, or XYZ only");
    cli::add_count(app, "--wavelengths", settings.wavelengths, "wavelengths of one sample", 4u, 32u);
    cli::add_count(app, "--precision", settings.precision, "mantissa bits of stored values, rounded without bias; 23: as they are",
                   1u, 23u);
    cli::add_count(app, "--seed", settings.seed, "another (not 0) is another job: independent samples");
    cli::add_count(app, "--run-samples", settings.run_samples, "samples of a run, a power of two, instead of runs near 64 MiB",
                   1024u, 4194304u);
    cli::add_duration(app, "--checkpoint", options.checkpoint_seconds, "commit finished work this often, above 0")
        ->default_str("60s");
    cli::add_duration(app, "--max-time", options.max_seconds, "stop after this time, above 0, as if by a signal: exit 75");
    app.add_option("--simd", settings.simd,
                   "instructions to use; best: the fastest of this processor but avx512. "
                   "Samples are equal bit for bit only at one level")
        ->capture_default_str()
        ->type_name(fmt::format("best|{}", fmt::join(simd_levels(), "|")));
    app.add_flag("--dry-run", dry_run,
                 "render for two seconds, then print how long the rest would take, how large the part would be, and what is free");
    app.add_flag("--ignore-space", ignore_space, "begin even if the part is not expected to fit on the disk");
    cli::add_common(app, common, false);
    app.footer(
        "Examples:\n"
        "  latent-render scenes/cornell.pbrt -o cornell.latent --spp 64\n"
        "  latent-render scenes/cornell.pbrt -o half0.latent --spp 64 --shard 0/2\n"
        "  latent-render scenes/cornell.pbrt -o half1.latent --spp 64 --shard 1/2\n"
        "  latent-render scenes/cornell.pbrt -o cornell.latent --spp 1024 --resolution 4096x4096 --dry-run\n\n"
        "Exit status: 0 done; 1 failed; 2 wrong usage; 3 done, but the report could not be written; 75 stopped with everything so "
        "far committed: run it again to go on");
    if (const auto done = cli::parse(app, argc, argv)) return *done;

    options.force = common.force;
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
        const Result<Forecast> expected = forecast(**job, options, 2, stop_requested);
        if (!expected) return cli::fail(expected.error());
        if (!expected->fits()) cli::warn(too_large(*expected, options.output));
        cli::print(to_text(*expected, common.json));
        return cli::kDone;
    }
    if (!ignore_space) {
        if (const Status fits = check_space(**job, options, stop_requested); !fits) return cli::fail(fits.error());
    }
    const Progress progress = cli::progress(common, "rendering");
    const Result<RenderReport> report = render::render(**job, options, stop_requested, progress);
    if (!report) return cli::fail(report.error());
    if (report->faults.total() > 0) cli::warn(to_text(report->faults));
    const int status = cli::print_report(to_text(*report, **job, common.json), cli::kDone);
    if (report->complete) return status;
    return cli::fail(
        {ErrorCode::kStopped, fmt::format("stopped: {} of {} samples are committed; run the same command again to go on",
                                          report->committed, (*job)->range.size())});
} catch (...) {
    return latent::cli::fail_with_exception();
}
