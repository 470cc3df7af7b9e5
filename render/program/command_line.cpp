#include "render/program/command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "base/simd.h"
#include "base/url.h"
#include "render/load/list_features.h"
#include "render/program/arguments.h"
#include "render/program/help.h"

namespace latent::render {

namespace {

// What to do with a file of another kind, by its name; empty if it may be a scene, or if there is none.
std::string no_scene(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return "";
    constexpr std::string_view kModels[] = {".3ds", ".abc", ".c4d", ".dae", ".fbx",  ".ma",   ".max", ".mb",
                                            ".ply", ".skp", ".stl", ".usd", ".usda", ".usdc", ".usdz"};
    const std::string name = shown_name(path), stem = path.stem().string(), extension = path.extension().string();
    if (extension == ".latent")
        return fmt::format("{}: holds samples, which are rendered already; develop them: latent-develop {} -o {}.exr", name,
                           path.string(), stem);
    if (extension == ".exr")
        return fmt::format("{}: is a picture; print it: latent-convert {} -o {}.png", name, path.string(), stem);
    if (extension == ".blend")
        return fmt::format(
            "{}: export it first (in Blender: File, Export, glTF 2.0; tick Cameras and Punctual Lights), then: "
            "latent-render {}.glb",
            name, stem);
    if (std::ranges::find(kModels, extension) != std::end(kModels))
        return fmt::format(
            "{}: export it as glTF (.glb) first, from the program that made it or from Blender, then: "
            "latent-render {}.glb",
            name, stem);
    return "";
}

// What glTF and OBJ files cannot say, or say more than once.
void add_model_arguments(CLI::App& app, ModelOptions& model) {
    app.add_option("--camera", model.camera, "camera of a glTF file, by its name, its node's name, or its number (default: 1)")
        ->type_name("NAME");
    app.add_option("--variant", model.variant, "variant of the materials of a glTF file, by its name")->type_name("NAME");
    app.add_option("--animation", model.animation, "animation of a glTF file, by its name or its number (default: 1)")
        ->type_name("NAME");
    cli::add_number(app, "--time", model.time, "moment of the animation, in seconds (default: the model rests)", 0, 1e6)
        ->type_name("SECONDS");
    cli::add_parsed(app, "--shutter", model.shutter, parse_shutter,
                    "the shutter is open from A to B seconds after --time, and what moves is blurred")
        ->type_name("A:B");
    cli::add_choice<ModelView>(
        app, "--view", model.view,
        {{"three-quarter", ModelView::kThreeQuarter}, {"front", ModelView::kFront}, {"top", ModelView::kTop}},
        "side from which a model without a camera is seen");
    cli::add_choice<bool>(app, "--up", model.is_z_up, {{"y", false}, {"z", true}}, "axis of a model that points up");
    app.add_flag_callback(
        "--no-stage", [&model] { model.stage = false; }, "no ground under a model without camera and lights");
    cli::add_positive_number(app, "--lens-radius", model.lens_radius, "radius of the lens of a model's camera, in its units")
        ->default_str("");
    cli::add_positive_number(app, "--focus", model.focus, "distance at which it is sharp (default: the middle of the model)")
        ->default_str("");
    app.add_option("--sky", model.sky, "picture of the sky of a model, in longitude and latitude")->type_name("FILE");
}

}  // namespace

void add_arguments(CLI::App& app, CommandLine& line) {
    app.add_option("SCENE", line.settings.scene, "scene file (.pbrt, .gltf, .glb, .obj)")
        ->required()
        ->check(CLI::Validator([](const std::string& name) { return no_scene(name); }, ""));
    app.add_option("-o,--output", line.options.output,
                   "file to write: one part of the job (for --dry-run and --preview, by default: SCENE's name, in this folder)")
        ->check(cli::ends_in(".latent"));
    auto* spp = cli::add_positive_number(app, "--spp", line.settings.spp, "samples per pixel of --resolution");
    auto* samples = cli::add_parsed(app, "--samples", line.settings.samples, parse_samples, "samples A to B-1, instead of --spp")
                        ->excludes(spp)
                        ->type_name("A:B");
    auto* more_than = app.add_option("--more-than", line.settings.more_than,
                                     "files or folders to continue: render only the samples of --spp that follow theirs")
                          ->excludes(samples)
                          ->type_name("FILE...");
    auto* shard = cli::add_parsed(app, "--shard", line.settings.shard, parse_shard, "shard to render, out of N; I is 0 to N-1")
                      ->type_name("I/N");
    auto* until = cli::add_parsed(app, "--until-noise", line.until, parse_noise_target,
                                  "instead of --spp, render until half of the pixels of a picture W pixels wide (default: of "
                                  "--resolution) have a smaller relative standard error than P percent")
                      ->excludes(spp)
                      ->excludes(samples)
                      ->excludes(more_than)
                      ->excludes(shard)
                      ->type_name("P%[@W]");
    cli::add_positive_number(app, "--max-spp", line.settings.spp, "samples per pixel after which --until-noise ends in any case")
        ->needs(until)
        ->default_str("");
    cli::add_parsed(
        app, "--resolution", line.settings.resolution, parse_resolution,
        "picture size in pixels to render for (default: the scene's); you can still develop any other size. It sets how "
        "many samples --spp makes, the pixels that they fill, and how finely textures are filtered")
        ->type_name("WxH");
    cli::add_choice<std::optional<IntegratorKind>>(app, "--integrator", line.settings.integrator,
                                                   {{"path", IntegratorKind::kPath}, {"bdpt", IntegratorKind::kBdpt}},
                                                   "path tracing or bidirectional path tracing (default: the scene's)");
    cli::add_choice<Connections>(app, "--connections", line.settings.connections,
                                 {{"one", Connections::kOne}, {"all", Connections::kAll}},
                                 "connections that bdpt makes for each path length: one at random, or all");
    cli::add_parsed(app, "--max-depth", line.settings.max_depth, parse_depth,
                    "maximum number of scattering vertices per path (default: the scene's)")
        ->type_name("N|unlimited");
    using sampledb::RecordKind;
    cli::add_choice<RecordKind>(app, "--record", line.settings.record,
                                {{"spectral", RecordKind::kSpectral}, {"xyz", RecordKind::kXyz}},
                                "contents of a record: a value for each wavelength, or XYZ only");
    cli::add_count(app, "--wavelengths", line.settings.wavelengths, "wavelengths per sample", 4u, 32u);
    using color::RgbSpectra;
    cli::add_choice<RgbSpectra>(app, "--rgb-spectra", line.settings.rgb_spectra,
                                {{"smooth", RgbSpectra::kSmooth}, {"basis", RgbSpectra::kBasis}},
                                "spectra of the scene's RGB colours: a smooth one for each colour, or a sum of three curves");
    app.add_flag("--light-groups", line.settings.light_groups,
                 "store the light of lights with different names separately, for latent-develop --light");
    cli::add_parsed(app, "--aov", line.settings.aovs, parse_aovs,
                    "also store features of the surface that each sample sees (albedo, normal, depth, position, id), for "
                    "latent-develop --layers, and where and when its light met the lens (lens, time); a list of these")
        ->type_name("albedo,normal,...");
    cli::add_count(app, "--precision", line.settings.precision,
                   "mantissa bits of each stored value; 23 keeps all, fewer are rounded without bias", 1u, 23u);
    cli::add_count(app, "--seed", line.settings.seed, "random seed; each seed is a separate job with independent samples");
    using sampledb::PositionSampler;
    cli::add_choice<PositionSampler>(
        app, "--sampler", line.settings.sampler, {{"pixels", PositionSampler::kPixels}, {"halton", PositionSampler::kHalton23}},
        "how samples are spread: evenly in each pixel of --resolution, with the least noise at that size, or over the film by a "
        "Halton sequence, whatever the size");
    cli::add_count(app, "--run-samples", line.settings.run_samples,
                   "samples per run, the unit of storage; a power of two (default: runs of about 64 MiB)", 1024u, 4194304u);
    cli::add_duration(app, "--checkpoint", line.options.checkpoint_seconds, "interval at which finished work is committed to disk")
        ->default_str("60s");
    cli::add_duration(app, "--max-time", line.options.max_seconds,
                      "time limit; the render stops with exit status 75 and can be resumed");
    cli::add_size(
        app, "--texture-cache", line.settings.texture_cache,
        "memory limit for decoded textures (default: what pictures without tiles need, from 256M to a quarter of the memory)")
        ->default_str("");
    app.add_option("--simd", line.settings.simd,
                   "instruction set for ray tracing; best is the fastest available up to avx2. Samples are bit-identical only with "
                   "the same set")
        ->capture_default_str()
        ->type_name(fmt::format("best|{}", fmt::join(simd_levels(), "|")));
    auto* dry = app.add_flag("--dry-run", line.dry_run,
                             "render for two seconds (or --max-time; with pictures as textures, up to four times), then print the "
                             "expected time and file size, and the free space");
    auto* preview = cli::add_duration(app, "--preview", line.preview_seconds,
                                      "time for a preview: a small picture, NAME.preview.png, and the forecast of --dry-run");
    preview->excludes(dry)->excludes(until);
    app.add_flag("--no-denoise", line.keep_noise, "leave the noise in the preview")->needs(preview);
    dry->excludes(until);
    add_model_arguments(app, line.settings.model);
    app.add_option("--add", line.settings.additions,
                   "pbrt file whose lights, shapes and camera are added to the scene; may be repeated")
        ->type_name("FILE")
        ->allow_extra_args(false);
    app.add_flag("--strict", line.settings.strict, "refuse the scene if anything that may affect its samples is ignored");
    app.add_flag_callback(
        "--list-features", [] { cli::print(list_features()), throw CLI::Success(); },
        "list the supported scene features, and exit");
    app.add_flag("--ignore-space", line.ignore_space, "start even if the file is not expected to fit on the disk");
    app.footer(kBelowOptions);
    app.parse_complete_callback([&line, &app] {
        constexpr double kMaxPerPixel = 1e6;  // for a picture that never gets clean
        if (line.until && app.get_option("--max-spp")->count() == 0) line.settings.spp = kMaxPerPixel;
        line.has_output = !line.options.output.empty();
        if (line.has_output) return;
        if (!line.dry_run && line.preview_seconds <= 0) throw CLI::RequiredError("--output");
        line.options.output = line.settings.scene.stem() += ".latent";
    });
}

}  // namespace latent::render
