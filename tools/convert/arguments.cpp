#include "tools/convert/arguments.h"

#include <fmt/format.h>

#include <array>

#include "base/parse.h"
#include "base/recipe_options.h"
#include "color/catalogue.h"
#include "tools/convert/help.h"
#include "tools/convert/looks.h"

namespace latent::convert {
namespace {

Result<std::array<double, 3>> luminances_of(const std::string& text) {
    const auto numbers = parse_numbers(text);
    if (numbers && numbers->size() == 3) return std::array{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    return is_not(text, "three luminances (try 0.2126,0.7152,0.0722)");
}

void add_darkroom(CLI::App& section, DarkroomOptions& darkroom) {
    section
        .add_option(
            "--paper", darkroom.paper,
            "print exposures that latent-develop --film wrote: a paper, print film, scan, light-table or projection; see below")
        ->type_name("NAME")
        ->check(cli::not_empty());
    cli::add_parsed(section, "--enlarger", darkroom.filters, parse_filters,
                    "yellow, magenta and cyan filter of the enlarger, in hundredths of density; auto prints a grey card neutral")
        ->type_name("auto|Y,M,C")
        ->default_str("auto");
    cli::add_number(section, "--print-exposure", darkroom.print_stops,
                    "light of the enlarger in stops; a negative prints darker with more", -10, 10);
    section
        .add_option("--contrast-filter", darkroom.contrast_filter,
                    "contrast of black-and-white paper: 00 (soft), 0, 1 ... 5 (hard)")
        ->type_name("00..5");
    section.add_flag("--couplers,!--no-couplers", darkroom.couplers,
                     "let the layers of the film hold each other back, which makes colours purer (default: on)");
    section.add_flag("--balance,!--no-balance", darkroom.balance,
                     "match the contrasts of the layers so that greys are neutral; a slide's grey card (default: on)");
    section.add_flag_function(
        "--grain,!--no-grain", [&darkroom](std::int64_t given) { darkroom.grain = given > 0; }, "show the grain of the film");
    section.add_flag_function(
        "--mtf,!--no-mtf", [&darkroom](std::int64_t given) { darkroom.mtf = given > 0; }, "blur the print as the film does");
    cli::add_parsed(section, "--halation", darkroom.halation, parse_halation,
                    "light that comes back from the base of the film, around lamps: a little (backed), or as much as without the "
                    "black back (bare)")
        ->type_name("none|backed|bare");
    section
        .add_option("--look", darkroom.look,
                    "paper, format, grain, sharpness and halation that go with a film; full: all of this for any film, on --paper; "
                    "--list-looks shows all")
        ->type_name("NAME");
    cli::add_parsed(
        section, "--format", darkroom.frame_mm, parse_format,
        "size of the frame on the film: 35mm, 6x6, 6x7, 4x5in, super8, ..., or its longer side in mm (default: 35mm, or "
        "as the look says)")
        ->type_name("FORMAT|MM");
    cli::add_count(section, "--grain-seed", darkroom.seed, "another piece of film: other grain of the same kind");
    section
        .add_option("--film", darkroom.film, "film that was exposed, if it is your own: FOLDER/NAME (default: as the picture says)")
        ->type_name("FOLDER/NAME")
        ->check(cli::not_empty());
}

void add_lists(CLI::App& app) {
    cli::add_list(
        app, "--list-observers", [] { return color::listing("observers (--observer)", color::observer_catalogue()); },
        "list all observers, cameras and films, with the sources of their numbers");
    cli::add_list(
        app, "--list-papers", [] { return film::list_views() + film::list_papers(); },
        "list all papers, print films and other ways to see a film");
    cli::add_list(app, "--list-looks", list_looks, "list all looks, and the films to develop with");
}

// What the pixels of the picture are.
void add_input(CLI::App& section, ConvertOptions& options) {
    section.add_option("--layer", options.layer, "layer of the picture to print: its channels NAME.R, NAME.G, NAME.B")
        ->type_name("NAME");
    section.add_option("--observer", options.observer, "observer, camera or film for a spectral picture (default: cie1931)")
        ->type_name("NAME|FILE.csv");
    section
        .add_option("--input-space", options.input_space,
                    "colour space of the pixels: xyz, or a space as for --profile (default: the picture's own, or srgb)")
        ->type_name("SPACE");
}

// Options that exclude or need each other are given as such: CLI11 looks names up where no memory must be lacking.
void add_exposure(CLI::App& section, ConvertOptions& options) {
    auto* sensitivity = cli::add_positive_number(
        section, "-s,--sensitivity", options.sensitivity,
        "sensitivity of the film; luminance 1/X prints at half of display white (default: --auto; 1 with --tone none)");
    auto* exposure = cli::add_parsed(section, "--exposure", options.exposure, parse_camera_exposure,
                                     "exposure as cameras are set, instead of --sensitivity: speed, time in seconds and f-number, "
                                     "in any order, such as iso:100,time:1/125,f:8")
                         ->type_name("iso:S,time:T,f:N")
                         ->excludes(sensitivity);
    cli::add_parsed(
        section, "--stops", options.stops, parse_stops,
        "exposure correction in stops (EV); negative is darker. Several, such as -1,0,1, write one print each, with the stops "
        "in its name")
        ->type_name("EV,...")
        ->default_str("0");
    section
        .add_flag("--auto", options.auto_exposure,
                  "choose the sensitivity from the whole picture: its mean prints at 18 % grey, or at --key; the report gives it")
        ->excludes(sensitivity)
        ->excludes(exposure);
    cli::add_number(section, "--key", options.key, "grey at which --auto prints the mean (default: 0.18)", 0.001, 0.999)
        ->excludes(sensitivity)
        ->excludes(exposure);
}

void add_tone_and_colour(CLI::App& section, ConvertOptions& options) {
    section
        .add_option("--tone", options.tone,
                    "tone curve: film (1 - 2^(-S Y), where S is the sensitivity), another one, or none; see below")
        ->type_name("CURVE")
        ->capture_default_str();
    cli::add_number(section, "--contrast", options.contrast,
                    "contrast of the tone curve, around half of display white, from 0.1 to 10", 0.1, 10);
    cli::add_number(section, "--black", options.black, "fraction of display white below which the print is black, from 0 to 0.5", 0,
                    0.5);
    section
        .add_option(
            "--gamut", options.gamut,
            "gamut mapping: luminance (preserves luminance), grey (the same, with less change of hue), or clip (preserves neither)")
        ->check(CLI::IsMember({"luminance", "grey", "clip"}))
        ->capture_default_str();
    section.add_option("--profile", options.profile, "profile of the display; see below")
        ->capture_default_str()
        ->type_name("NAME|FILE.icc");
    cli::add_choice<Intent>(section, "--intent", options.rendering.intent,
                            {{"perceptual", Intent::kPerceptual},
                             {"relative", Intent::kRelative},
                             {"saturation", Intent::kSaturation},
                             {"absolute", Intent::kAbsolute}},
                            "rendering intent, for profiles with tables");
    section.add_flag("--black-point-compensation,!--no-black-point-compensation", options.rendering.black_point_compensation,
                     "map the darkest colour of the picture to that of the device, for profiles with tables (default: on)");
    section
        .add_option("--proof", options.proof,
                    "soft proof: show on the display how the print will look on the device of this profile")
        ->type_name("FILE.icc");
    cli::add_choice<bool>(
        section, "--show", options.show_clipped, {{"print", false}, {"clipped", true}},
        "print, or clipped: a grey proof in which burnt pixels are red, black pixels blue, and pixels out of gamut magenta");
    cli::add_parsed(section, "--luminance-row", options.luminance_row, luminances_of,
                    "luminances of red, green and blue; needed only if the matrix is singular")
        ->type_name("R,G,B");
    cli::add_parsed(section, "--white", options.white, parse_white,
                    "light of the scene that prints neutral; see below (default: the picture's own white)")
        ->type_name("WHITE");
    section.add_option("--adapt", options.adapt, "chromatic adaptation from that white to the white of the display")
        ->check(CLI::IsMember({"bradford", "cat16"}))
        ->capture_default_str();
}

// What a lens does to the light of the scene.
void add_lens(CLI::App& section, ConvertOptions& options) {
    cli::add_parsed(section, "--vignette", options.vignette, parse_vignette,
                    "darken the corners as a simple lens does, by the fourth power of the cosine; the longer side of the picture "
                    "covers 40 degrees, or as many as given")
        ->type_name("cos4[:DEGREES]");
    cli::add_parsed(
        section, "--glare", options.glare, parse_glare,
        "spread the light of lamps as the aperture of a lens does (f:16, or blades:6,f:8; f:8 by default), or as an eye does; "
        "see below")
        ->type_name("GLARE|FILE.exr");
}

// What is done under the enlarger.
void add_hands(CLI::App& section, ConvertOptions& options) {
    const auto take = [&options](const std::vector<std::string>& texts) {
        options.dodges.clear();
        for (const std::string& text : texts) {
            Result<Dodge> dodge = parse_dodge(text);
            if (!dodge) throw CLI::ValidationError("--dodge", dodge.error().message);
            options.dodges.push_back(*std::move(dodge));
        }
    };
    section
        .add_option_function<std::vector<std::string>>(
            "--dodge", take, "print a part EV stops brighter, or darker (burn) if EV is negative; may be repeated; see below")
        ->type_name("brush:EV,RADIUS,X,Y,...|gradient:EV,X0,Y0,X1,Y1")
        ->allow_extra_args(false);
}

void add_code_values(CLI::App& section, ConvertOptions& options) {
    section.add_flag("--gray,--grey", options.grey, "write one channel, the luminance of the print, with a profile of grey");
    cli::add_choice<Depth>(section, "--bits", options.depth, {{"8", Depth::k8}, {"16", Depth::k16}, {"float", Depth::kFloat}},
                           "bits per channel (default: 8, or float in EXR, where 16 means half float)");
    auto* dither = cli::add_choice<color::Dither>(section, "--dither", options.dither,
                                                  {{"none", color::Dither::kNone},
                                                   {"random", color::Dither::kRandom},
                                                   {"triangular", color::Dither::kTriangular},
                                                   {"blue", color::Dither::kBlue}},
                                                  "dither of 8-bit output: random noise, noise of twice the range that is the "
                                                  "same at all levels (triangular), or a fine pattern (blue)");
    section
        .add_flag_callback(
            "--no-dither", [&options] { options.dither = color::Dither::kNone; }, "the same as --dither none")
        ->excludes(dither);
}

// Which of them are printed.
void add_part(CLI::App& section, ConvertOptions& options) {
    cli::add_crop(section, options.crop, "pixels to print, X1 and Y1 exclusive");
    cli::add_count(section, "--level", options.level, "mip level to read; each is half the size of the one before", 0, 31);
}

// How files hold the print, and how large it is on paper.
void add_file(CLI::App& section, ConvertOptions& options) {
    auto* dpi = cli::add_count(section, "--dpi", options.dpi,
                               "pixels per inch on paper, stored in TIFF, PNG, JPEG and EXR; does not change pixels", 1, 65535);
    cli::add_number(section, "--paper-width", options.paper_width_mm,
                    "width on paper in mm, instead of --dpi; stored as the nearest whole number of pixels per inch", 0.1, 1e6)
        ->type_name("MM")
        ->default_str("")
        ->excludes(dpi);
    cli::add_count(section, "--quality", options.quality, "quality of JPEG files and JPEG tiles", 1, 100);
    cli::add_count(section, "--compression", options.png_level, "compression level of PNG and TIFF; 1 is fastest, 9 smallest", 1,
                   9);
    section.add_flag("--tiles", options.tiles, "write TIFF in tiles of 256 x 256 pixels");
    section.add_flag("--pyramid", options.pyramid, "write TIFF as tiled pages, each half the size of the one before");
    section.add_flag("--png-tiles", options.png_tiles, "write Deep Zoom tiles as PNG instead of JPEG");
    cli::add_count(section, "--overlap", options.overlap,
                   "pixels that Deep Zoom tiles share with their neighbours; use 0 only for viewers other than NAME.html", 0, 1);
}

}  // namespace

CLI::App& add_decisions(CLI::App& app, ConvertOptions& options) {
    CLI::App& section = cli::add_section(app, "convert");
    add_input(section, options);
    add_exposure(section, options);
    add_tone_and_colour(section, options);
    add_lens(section, options);
    add_hands(section, options);
    add_darkroom(section, options.darkroom);
    add_code_values(section, options);
    add_part(section, options);
    add_file(section, options);
    return section;
}

void add_outputs(CLI::App& app, ConvertOptions& options) {
    app.add_option("-o,--output", options.outputs, "file to write; may be repeated")
        ->required()
        ->allow_extra_args(false)
        ->type_name("FILE");
    app.add_option("--compare", options.compare,
                   "Deep Zoom print of the same size; a divider in NAME.html shows it beside the new one")
        ->type_name("OTHER.dzi");
    app.add_flag("--gamut-report", options.gamut_report, "also report the largest shift of hue that gamut mapping causes");
}

CLI::App& add_arguments(CLI::App& app, ConvertOptions& options) {
    app.footer(help::kConvert);
    app.add_option("IMAGE", options.input, "EXR picture: from latent-develop, in linear RGB, or spectral")->required();
    add_outputs(app, options);
    CLI::App& decisions = add_decisions(app, options);
    cli::add_recipe(app);
    add_lists(app);
    return decisions;
}

}  // namespace latent::convert
