#include "tools/develop/arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/parse.h"
#include "base/recipe_options.h"
#include "sampledb/data/parse.h"
#include "tools/develop/kernel/splat.h"

namespace latent::develop {

namespace {

constexpr const char* kHelp = R"(
Size, filter and observer are chosen here, not when rendering: develop again for
another choice. Pixels are linear XYZ; print them with latent-convert. They are
bit-identical for any --threads, --memory, --crop, --simd and order of files.

Filters (default quartic:-3,1.5; parameters may be left out):
  quartic:s,R              no negative weights for s >= -3; lower s is sharper,
                           but rings; R is the radius in pixels
  gaussian:sigma,R         no negative weights; sigma and R in pixels
  mitchell:B,C             sharp; rings
  mitchell-separable:B,C   the same in x times y, so not isotropic
  lanczos                  sharp; rings most
  box                      the pixel's own square

Observers (default cie1931; --list-observers shows all):
  cie1931, cie1964, cie2015-2, cie2015-10
  canon_eos_5d ...         cameras: R, G, B of the sensor; D65 is (1, 1, 1)
  kodak_trix_400 ...       black-and-white films
  FILE.csv                 wavelength in nm, then three responses or one

Films (--list-films shows all): portra-400, gold-200, velvia-50, tri-x-400, ...
The picture holds the exposures of their layers, for latent-convert --paper.

Examples:
  latent-develop night.latent --size 2048 -o night.exr
      develop a picture 2048 pixels wide
  latent-develop night.latent --size 32768 --memory 512M --mipmap -o wall.exr
      develop a very large picture, with smaller levels
  latent-develop night.latent --size 32768 --crop 0,0,512,512 -o corner.exr
      develop a corner of it, with the same pixels
  latent-develop night.latent --size 2048 --observer kodak_trix_400 \
      --lens-filter wratten-25 --filter-factor auto -o film.exr
      photograph on film, behind a red filter (needs spectral records)
  latent-develop night.latent --film portra-400 --ei 200 -o exposures.exr
      photograph on colour film, one stop more than its box says
  latent-develop portrait.latent --aperture 0.35,blades:6 -o deep.exr
      stop the lens down, and give it six blades (needs --aov lens)
  latent-develop car.latent --shutter 0.4:0.6 -o sharp.exr
      expose for the middle fifth of the time (needs --aov time)
  latent-develop night.latent --light lamp=2.5 --light sky=6500K,0.3 -o dusk.exr
      change the lights of a file that was rendered with --light-groups
  latent-develop parts/ --budget 10s -o preview.exr
      preview a running render in about ten seconds

Exit status: 0 done; 1 failed, no output; 2 wrong usage; 3 done, but damaged,
foreign, missing or non-finite input was left out, or the report could not be
written.)";

// Returns the options that no spectral picture has.
std::vector<CLI::Option*> add_observer(CLI::App& section, ObserverOptions& options) {
    auto* name =
        section.add_option("--observer", options.name, "observer, camera or film whose response curves are applied; see below")
            ->type_name("NAME|FILE.csv");
    auto* output =
        cli::add_choice<bool>(section, "--camera-output", options.camera_xyz, {{"raw", false}, {"xyz", true}},
                              "pixels of a camera: R, G, B of its sensor, or XYZ by a matrix fitted to a ColorChecker under D65");
    auto* balance = cli::add_choice<bool>(
        section, "--raw-balance", options.balanced, {{"daylight", true}, {"none", false}},
        "white balance of a camera: daylight (D65 is (1, 1, 1)), or none (one scale for all channels, set by green)");
    auto* film =
        section
            .add_option("--film", options.film,
                        "photographic film: the picture holds the exposures of its layers; print it with latent-convert --paper")
            ->type_name("NAME|FOLDER/NAME")
            ->check(cli::not_empty())
            ->excludes(name)
            ->excludes(output)
            ->excludes(balance);
    cli::add_number(section, "--ei", options.exposure_index,
                    "exposure index that the film is exposed for (default: that of its box)", 0.01, 1e6)
        ->default_str("")
        ->needs(film);
    cli::add_number(section, "--push", options.push, "stops by which the film is developed longer (negative: shorter)", -1, 2)
        ->needs(film);
    auto* filter = section
                       .add_option("--lens-filter", options.lens_filter,
                                   "filter in front of the lens, such as wratten-25, or mired:131, a conversion filter")
                       ->type_name("NAME");
    cli::add_parsed(section, "--filter-factor", options.filter_factor, parse_filter_factor,
                    "factor by which to multiply the exposure; auto makes up for the light of D65 that the filter absorbs")
        ->type_name("none|auto|X")
        ->default_str("none");
    return {name, output, balance, film, filter};
}

void add_lens(CLI::App& section, PictureOptions& options) {
    LensChoice& lens = options.lens;
    const auto aperture = [&lens](const std::string& text) {
        lens.aperture_text = text;
        return parse_aperture(text);
    };
    cli::add_parsed(section, "--aperture", lens.aperture, aperture,
                    "smaller aperture: a fraction of the rendered radius, f:N, blades:N[:ROTATION[:CURVATURE]], gaussian, "
                    "anamorphic:X, cat-eye:X, left or right (half of the lens, for stereo); needs files rendered with "
                    "--aov lens")
        ->type_name("0..1,...");
    const auto shutter = [&lens](const std::string& text) {
        lens.shutter_text = text;
        return parse_shutter(text);
    };
    cli::add_parsed(section, "--shutter", lens.shutter, shutter,
                    "shorter exposure: parts of the one that was rendered, from 0 to 1; soft, film or FILE.csv (time, "
                    "transmission); rolling:X; needs files rendered with --aov time")
        ->type_name("A:B,...|FILE.csv");
    section.add_flag("--exposure-follows", lens.exposure_follows,
                     "a smaller aperture and a shorter exposure make a darker picture, as in a camera");
    cli::add_parsed(section, "--focus", options.focus, parse_focus,
                    "refocus: a distance from the lens in the units of the scene, or a pixel of the picture whose surface is to be "
                    "sharp (this needs files rendered with --aov depth,lens)")
        ->type_name("DISTANCE|X,Y");
    cli::add_count(section, "--frames", options.frames,
                   "divide the exposure into so many frames, each a picture of its own: NAME.0001.exr, NAME.0002.exr, ...", 1u,
                   256u);
}

void add_lists(CLI::App& app) {
    cli::add_list(app, "--list-films", film::list_films, "list all films: kind, speed, and how complete their data are");
    cli::add_list(app, "--list-observers", list_observers,
                  "list all observers, cameras, films and filters, with the sources of their numbers");
}

}  // namespace

Result<double> parse_filter_factor(std::string_view text) {
    if (text == "none") return 1.0;
    if (text == "auto") return 0.0;
    const Result<double> factor = parse_number(text);
    if (factor && *factor > 0) return factor;
    return is_not(text, "a filter factor (try none, auto or 8)");
}

Result<double> parse_fraction(std::string_view text) {
    const Result<double> fraction = parse_number(text);
    if (fraction && *fraction > 0 && *fraction <= 1) return fraction;
    return is_not(text, "a fraction (try 0.01)");
}

CLI::App& add_decisions(CLI::App& app, PictureOptions& options) {
    CLI::App& section = cli::add_section(app, "develop");
    section
        .add_option(
            "--size", options.size,
            "size of the whole picture in pixels; W alone keeps the film's aspect (default: what the file was rendered for)")
        ->type_name("W|WxH");
    cli::add_crop(section, options.crop, "pixels to develop, X1 and Y1 exclusive");
    section.add_option("--filter", options.filter, "pixel filter; see below")->capture_default_str()->type_name("NAME[:params]");
    const std::vector<CLI::Option*> observer = add_observer(section, options.observer);
    section
        .add_option("--light", options.lights,
                    "change to the lights called NAME: factors, filters or a new spectrum; may be repeated; needs files rendered "
                    "with --light-groups")
        ->type_name("NAME=X|FILTER|6500K,...")
        ->allow_extra_args(false);
    add_lens(section, options);
    cli::add_parsed(section, "--fraction", options.fraction, parse_fraction,
                    "preview: fraction of the samples to develop, in whole runs; each run covers the whole picture")
        ->type_name("0..1");
    section.add_option("--image", options.image, "camera image, light image, or both (the picture is their sum)")
        ->check(CLI::IsMember({"both", "camera", "light"}))
        ->capture_default_str();
    section.add_flag("--mipmap", options.mipmap, "also store smaller levels, whose pixels are means of those they cover");
    auto* bins = cli::add_parsed(section, "--spectral-bins", options.spectral_bins, parse_spectral_bins,
                                 "spectral bins to store instead of XYZ, as radiance per nm: a number of bins from 360 to 830 nm, "
                                 "or their range and width in nm")
                     ->type_name("N|FROM:TO:STEP");
    auto* ratio = cli::add_choice<bool>(
        section, "--estimator", options.ratio, {{"standard", false}, {"ratio", true}},
        "estimator of the colours of the camera image: standard is unbiased; ratio has less colour noise with "
        "few samples");
    bins->excludes(ratio);
    for (CLI::Option* option : observer) bins->excludes(option);
    const auto layers = [&options](const std::string& text) {
        Result<Layers> chosen = parse_layers(text);
        if (chosen) chosen->halves = options.layers.halves;
        return chosen;
    };
    cli::add_parsed(
        section, "--layers", options.layers, layers,
        "further layers to store: noisy (the picture before --denoise), variance of the camera image, weight (sum of filter "
        "weights), count (number of samples); "
        "lights (the picture by each group of lights alone), of files rendered with --light-groups; of "
        "files rendered with --aov: albedo, normal, depth, position, id; of any other column of the files, by its name: its mean")
        ->type_name("NAME,...");
    section.add_flag("--halves", options.layers.halves,
                     "also store the picture of each half of the samples; their difference shows the noise");
    section.add_flag("--dim-fireflies", options.dim_fireflies,
                     "dim samples that are far brighter than all others around them; the report gives the light that is lost");
    const auto none = [](std::string& amount) {  // CLI11 makes -1 of 0 and of false
        if (amount == "-1" || amount == "false" || amount == "0") amount = "0.0";
        return std::string();
    };
    section
        .add_flag("--denoise{1}", options.denoise,
                  "remove noise, with the help of the layers albedo, normal and depth if the files have them; --denoise=0.5 "
                  "removes half of it")
        ->transform(CLI::Validator(none, ""));
    cli::add_choice<bool>(section, "--compression", options.zip, {{"none", false}, {"zip", true}}, "compression of the EXR file");
    return section;
}

void add_inputs(CLI::App& app, PictureOptions& options) {
    app.add_option("FILE", options.inputs, "files of one job, their http(s) URLs, or folders of files")->required();
    app.add_flag("--skip-duplicates", options.skip_duplicates, "accept files that hold the same samples; each sample is used once");
    cli::add_parsed(app, "--job", options.job, sampledb::parse_job_id,
                    "job to develop, if folders hold several (32 hexadecimal digits)")
        ->type_name("ID");
    cli::add_parsed(app, "--samples", options.samples, sampledb::parse_sample_range, "samples to use, A to B-1 (default: all)")
        ->type_name("A:B");
    app.add_flag("--ignore-space", options.ignore_space, "start even if the file is not expected to fit on the disk");
}

CLI::App& add_arguments(CLI::App& app, PictureOptions& options) {
    app.footer(kHelp);
    add_inputs(app, options);
    auto* output = app.add_option("-o,--output", options.output, "picture to write");
    output->check(
        cli::ends_in(".exr", "; develop to .exr first, then print: latent-convert FILE.exr -o FILE.png (or .tif, .jpg, .dzi)"));
    CLI::App& decisions = add_decisions(app, options);
    app.add_option("--for-oidn", options.for_oidn,
                   "write the files that Open Image Denoise takes, instead of an EXR: PREFIX.hdr.pfm, and, of files "
                   "rendered with --aov albedo,normal, PREFIX.alb.pfm and PREFIX.nrm.pfm")
        ->type_name("PREFIX")
        ->excludes(output);
    cli::add_recipe(app);
    cli::add_duration(app, "--budget", options.budget_seconds, "preview: time to spend; develops as many runs as it allows")
        ->excludes(decisions.get_option("--fraction"));
    app.add_option("--simd", options.simd, "instruction set; does not affect pixels")
        ->capture_default_str()
        ->type_name(fmt::format("best|{}", fmt::join(simd_levels(), "|")));
    add_lists(app);
    return decisions;
}

}  // namespace latent::develop
