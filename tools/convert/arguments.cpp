#include "tools/convert/arguments.h"

#include <fmt/format.h>

#include <array>

#include "base/parse.h"
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

void add_darkroom(CLI::App& app, DarkroomOptions& darkroom) {
    app.add_option(
           "--paper", darkroom.paper,
           "print exposures that latent-develop --film wrote: a paper, print film, scan, light-table or projection; see below")
        ->type_name("NAME")
        ->check(cli::not_empty());
    app.add_flag_callback(
        "--list-papers",
        [] {
            cli::print(film::list_views() + film::list_papers());
            throw CLI::Success();
        },
        "list all papers, print films and other ways to see a film");
    cli::add_parsed(app, "--enlarger", darkroom.filters, parse_filters,
                    "yellow, magenta and cyan filter of the enlarger, in hundredths of density; auto prints a grey card neutral")
        ->type_name("auto|Y,M,C")
        ->default_str("auto");
    cli::add_number(app, "--print-exposure", darkroom.print_stops,
                    "light of the enlarger in stops; a negative prints darker with more", -10, 10);
    app.add_option("--contrast-filter", darkroom.contrast_filter, "contrast of black-and-white paper: 00 (soft), 0, 1 ... 5 (hard)")
        ->type_name("00..5");
    app.add_flag("--couplers,!--no-couplers", darkroom.couplers,
                 "let the layers of the film hold each other back, which makes colours purer (default: on)");
    app.add_flag("--balance,!--no-balance", darkroom.balance,
                 "match the contrasts of the layers so that greys are neutral; a slide's grey card (default: on)");
    app.add_flag_function(
        "--grain,!--no-grain", [&darkroom](std::int64_t given) { darkroom.grain = given > 0; }, "show the grain of the film");
    app.add_flag_function(
        "--mtf,!--no-mtf", [&darkroom](std::int64_t given) { darkroom.mtf = given > 0; }, "blur the print as the film does");
    cli::add_parsed(app, "--halation", darkroom.halation, parse_halation,
                    "light that comes back from the base of the film, around lamps: a little (backed), or as much as without the "
                    "black back (bare)")
        ->type_name("none|backed|bare");
    app.add_option("--look", darkroom.look,
                   "paper, format, grain, sharpness and halation that go with a film; full: all of this for any film, on --paper; "
                   "--list-looks shows all")
        ->type_name("NAME");
    app.add_flag_callback(
        "--list-looks",
        [] {
            cli::print(list_looks());
            throw CLI::Success();
        },
        "list all looks, and the films to develop with");
    cli::add_parsed(app, "--format", darkroom.frame_mm, parse_format,
                    "size of the frame on the film: 35mm, 6x6, 6x7, 4x5in, super8, ..., or its longer side in mm")
        ->type_name("FORMAT|MM")
        ->default_str("35mm");
    cli::add_count(app, "--grain-seed", darkroom.seed, "another piece of film: other grain of the same kind");
    app.add_option("--film", darkroom.film, "film that was exposed, if it is your own: FOLDER/NAME (default: as the picture says)")
        ->type_name("NAME")
        ->check(cli::not_empty());
}

}  // namespace

void add_arguments(CLI::App& app, ConvertOptions& options) {
    app.add_option("IMAGE", options.input, "EXR picture: from latent-develop, in linear RGB, or spectral")->required();
    app.add_option("-o,--output", options.outputs, "file to write; may be repeated")
        ->required()
        ->allow_extra_args(false)
        ->type_name("FILE");
    app.add_option("--layer", options.layer, "layer of the picture to print: its channels NAME.R, NAME.G, NAME.B")
        ->type_name("NAME");
    app.add_option("--observer", options.observer, "observer, camera or film for a spectral picture (default: cie1931)")
        ->type_name("NAME|FILE.csv");
    app.add_flag_callback(
        "--list-observers",
        [] {
            cli::print(color::listing("observers (--observer)", color::observer_catalogue()));
            throw CLI::Success();
        },
        "list all observers, cameras and films, with the sources of their numbers");
    app.add_option("--input-space", options.input_space,
                   "colour space of the pixels: xyz, or a space as for --profile (default: the picture's own, or srgb)")
        ->type_name("SPACE");
    auto* sensitivity = cli::add_positive_number(
        app, "-s,--sensitivity", options.sensitivity,
        "sensitivity of the film; luminance 1/X prints at half of display white (default: --auto; 1 with --tone none)");
    cli::add_parsed(
        app, "--stops", options.stops, parse_stops,
        "exposure correction in stops (EV); negative is darker. Several, such as -1,0,1, write one print each, with the stops "
        "in its name")
        ->type_name("EV,...")
        ->default_str("0");
    // Options that exclude or need each other are given as such: CLI11 looks names up where no memory must be lacking.
    app.add_flag("--auto", options.auto_exposure,
                 "choose the sensitivity from the whole picture: its mean prints at 18 % grey, or at --key; the report gives it")
        ->excludes(sensitivity);
    cli::add_number(app, "--key", options.key, "grey at which --auto prints the mean (default: 0.18)", 0.001, 0.999)
        ->excludes(sensitivity);
    app.add_option("--tone", options.tone,
                   "tone curve: film (1 - 2^(-S Y), where S is the sensitivity), another one, or none; see below")
        ->type_name("CURVE")
        ->capture_default_str();
    cli::add_number(app, "--contrast", options.contrast, "contrast of the tone curve, around half of display white, from 0.1 to 10",
                    0.1, 10);
    cli::add_number(app, "--black", options.black, "fraction of display white below which the print is black, from 0 to 0.5", 0,
                    0.5);
    app.add_option(
           "--gamut", options.gamut,
           "gamut mapping: luminance (preserves luminance), grey (the same, with less change of hue), or clip (preserves neither)")
        ->check(CLI::IsMember({"luminance", "grey", "clip"}))
        ->capture_default_str();
    app.add_option("--profile", options.profile, "profile of the display; see below")->capture_default_str()->type_name("PROFILE");
    cli::add_choice<Intent>(app, "--intent", options.rendering.intent,
                            {{"perceptual", Intent::kPerceptual},
                             {"relative", Intent::kRelative},
                             {"saturation", Intent::kSaturation},
                             {"absolute", Intent::kAbsolute}},
                            "rendering intent, for profiles with tables");
    app.add_flag("--black-point-compensation,!--no-black-point-compensation", options.rendering.black_point_compensation,
                 "map the darkest colour of the picture to that of the device, for profiles with tables (default: on)");
    app.add_option("--proof", options.proof,
                   "soft proof: show on the display how the print will look on the device of this profile")
        ->type_name("FILE.icc");
    app.add_flag("--gamut-report", options.gamut_report, "also report the largest shift of hue that gamut mapping causes");
    cli::add_choice<bool>(
        app, "--show", options.show_clipped, {{"print", false}, {"clipped", true}},
        "print, or clipped: a grey proof in which burnt pixels are red, black pixels blue, and pixels out of gamut magenta");
    cli::add_parsed(app, "--luminance-row", options.luminance_row, luminances_of,
                    "luminances of red, green and blue; needed only if the matrix is singular")
        ->type_name("R,G,B");
    cli::add_parsed(app, "--white", options.white, parse_white,
                    "light of the scene that prints neutral; see below (default: the picture's own white)")
        ->type_name("WHITE");
    app.add_option("--adapt", options.adapt, "chromatic adaptation from that white to the white of the display")
        ->check(CLI::IsMember({"bradford", "cat16"}))
        ->capture_default_str();
    cli::add_parsed(app, "--vignette", options.vignette, parse_vignette,
                    "darken the corners as a simple lens does, by the fourth power of the cosine; the longer side of the picture "
                    "covers 40 degrees, or as many as given")
        ->type_name("cos4[:DEGREES]");
    cli::add_parsed(
        app, "--glare", options.glare, parse_glare,
        "spread the light of lamps as the aperture of a lens does (f:16, or blades:6,f:8; f:8 by default), or as an eye does; "
        "see below")
        ->type_name("GLARE");
    add_darkroom(app, options.darkroom);
    app.add_flag("--gray,--grey", options.grey, "write one channel, the luminance of the print, with a profile of grey");
    cli::add_choice<Depth>(app, "--bits", options.depth, {{"8", Depth::k8}, {"16", Depth::k16}, {"float", Depth::kFloat}},
                           "bits per channel (default: 8, or float in EXR, where 16 means half float)");
    auto* dither = cli::add_choice<color::Dither>(app, "--dither", options.dither,
                                                  {{"none", color::Dither::kNone},
                                                   {"random", color::Dither::kRandom},
                                                   {"triangular", color::Dither::kTriangular},
                                                   {"blue", color::Dither::kBlue}},
                                                  "dither of 8-bit output: random noise, noise of twice the range that is the "
                                                  "same at all levels (triangular), or a fine pattern (blue)");
    app.add_flag_callback(
           "--no-dither", [&options] { options.dither = color::Dither::kNone; }, "the same as --dither none")
        ->excludes(dither);
    cli::add_crop(app, options.crop, "pixels to print, X1 and Y1 exclusive");
    cli::add_count(app, "--level", options.level, "mip level to read; each is half the size of the one before", 0, 31);
    auto* dpi = cli::add_count(app, "--dpi", options.dpi,
                               "pixels per inch on paper, stored in TIFF, PNG, JPEG and EXR; does not change pixels", 1, 65535);
    cli::add_number(app, "--paper-width", options.paper_width_mm,
                    "width on paper in mm, instead of --dpi; stored as the nearest whole number of pixels per inch", 0.1, 1e6)
        ->type_name("MM")
        ->default_str("")
        ->excludes(dpi);
    cli::add_count(app, "--quality", options.quality, "quality of JPEG files and JPEG tiles", 1, 100);
    cli::add_count(app, "--compression", options.png_level, "compression level of PNG and TIFF; 1 is fastest, 9 smallest", 1, 9);
    app.add_flag("--tiles", options.tiles, "write TIFF in tiles of 256 x 256 pixels");
    app.add_flag("--pyramid", options.pyramid, "write TIFF as tiled pages, each half the size of the one before");
    app.add_flag("--png-tiles", options.png_tiles, "write Deep Zoom tiles as PNG instead of JPEG");
    cli::add_count(app, "--overlap", options.overlap,
                   "pixels that Deep Zoom tiles share with their neighbours; use 0 only for viewers other than NAME.html", 0, 1);
    app.add_option("--compare", options.compare,
                   "Deep Zoom print of the same size; a divider in NAME.html shows it beside the new one")
        ->type_name("OTHER.dzi");
    app.footer(help::kConvert);
}

}  // namespace latent::convert
