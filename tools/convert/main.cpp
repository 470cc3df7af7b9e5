// latent-convert: from developed pixels to a print.
#include <fmt/format.h>

#include <array>

#include "base/cli.h"
#include "base/parse.h"
#include "base/temporary_path.h"
#include "tools/convert/convert.h"
#include "tools/convert/report.h"

namespace {

constexpr const char* kExamples = R"(
Formats, by the output's extension: .png .tif .jpg (display pixels with a colour profile), .exr (the print in linear light),
.dzi (a Deep Zoom pyramid of tiles, with NAME.html beside it that shows it: open it by double click).

Examples:
  latent-convert picture.exr -o picture.png
  latent-convert picture.exr -o auto.png --auto                                choose the sensitivity; prints the one it chose
  latent-convert picture.exr -o picture.tif --bits 16 --profile display-p3 --stops -0.5
  latent-convert picture.exr -o wall.tif --tiles --pyramid                     BigTIFF where needed
  latent-convert picture.exr -o web.dzi -o preview.jpg --memory 256M           two outputs in one pass, any size
  latent-convert picture.exr -o corner.png --crop 0,0,512,512

Exit status: 0 done; 1 failed, no output; 2 wrong usage; 3 done, but some pixels were not numbers, or the
report could not be written.)";

latent::Result<std::array<double, 3>> luminances_of(const std::string& text) {
    const auto numbers = latent::parse_numbers(text);
    if (numbers && numbers->size() == 3) return std::array{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    return latent::Error{latent::ErrorCode::kUsage, "'" + text + "' is not three luminances (try 0.2126,0.7152,0.0722)"};
}

void add_options(CLI::App& app, latent::convert::ConvertOptions& options) {
    namespace cli = latent::cli;
    using latent::convert::Depth;
    app.add_option("IMAGE", options.input, "EXR from latent-develop, or of linear RGB")->required();
    app.add_option("-o,--output", options.outputs, "what to write; may repeat")
        ->required()
        ->allow_extra_args(false)
        ->type_name("FILE");
    auto* sensitivity =
        cli::add_positive_number(app, "-s,--sensitivity", options.sensitivity, "sensitivity of the film: Y = 1/S prints at half");
    cli::add_number(app, "--stops", options.stops, "push the sensitivity by so many stops", -100, 100)->type_name("EV");
    app.add_flag("--auto", options.auto_exposure, "choose the sensitivity: the mean prints at 18 % grey")->excludes(sensitivity);
    app.add_option("--tone", options.tone, "film: 1 - 2^(-S Y); none: only converts")
        ->check(CLI::IsMember({"film", "none"}))
        ->capture_default_str();
    app.add_option("--gamut", options.gamut, "luminance: exact brightness; grey: that and truer hue; clip: neither")
        ->check(CLI::IsMember({"luminance", "grey", "clip"}))
        ->capture_default_str();
    app.add_option("--profile", options.profile,
                   "srgb, display-p3, rec2020, adobe-rgb; rx,ry,gx,gy,bx,by,wx,wy; 9 numbers, the matrix XYZ to RGB; or FILE.icc")
        ->capture_default_str();
    cli::add_parsed(app, "--luminance-row", options.luminance_row, luminances_of,
                    "luminances of the primaries, instead of the profile's")
        ->type_name("R,G,B");
    cli::add_choice<Depth>(app, "--bits", options.depth, {{"8", Depth::k8}, {"16", Depth::k16}, {"float", Depth::kFloat}},
                           "8 by default, but float for EXR, where 16 means half");
    app.add_flag("--dither,!--no-dither", options.dither, "hide the steps of 8 bits in noise (default on)");
    const auto crop = [](const std::string& text) {
        return latent::parse_crop(text).map([](const auto& c) { return latent::image::Rect{c[0], c[1], c[2], c[3]}; });
    };
    cli::add_parsed(app, "--crop", options.crop, crop, "only these pixels, ends exclusive")->type_name("X0,Y0,X1,Y1");
    cli::add_count(app, "--level", options.level, "mip level of the input: 1 is half its size, ...", 0, 31);
    cli::add_count(app, "--dpi", options.dpi, "pixels per inch on paper, as TIFF, PNG, JPEG and EXR say it; changes no pixel", 1,
                   65535);
    cli::add_count(app, "--quality", options.quality, "of JPEG and Deep Zoom's tiles", 1, 100);
    cli::add_count(app, "--compression", options.png_level, "of PNG and TIFF; 9: small", 1, 9);
    app.add_flag("--tiles", options.tiles, "TIFF in tiles of 256 x 256");
    app.add_flag("--pyramid", options.pyramid, "TIFF with smaller and smaller copies, in tiles");
    app.add_flag("--png-tiles", options.png_tiles, "Deep Zoom in PNG instead of JPEG");
    cli::add_count(app, "--overlap", options.overlap,
                   "pixels of its neighbours around each tile of Deep Zoom; 0 is for other viewers than NAME.html", 0, 1);
    app.footer(kExamples);
}

}  // namespace

int main(int argc, char** argv) try {
    namespace cli = latent::cli;
    latent::convert::ConvertOptions options;
    cli::CommonOptions common;
    CLI::App app{"Print a developed picture: tone, gamut and encoding for a display, at any size, in fixed memory.",
                 "latent-convert"};
    add_options(app, options);
    cli::add_common(app, common, true);
    if (const auto done = cli::parse(app, argc, argv)) return *done;
    options.threads = common.threads;
    options.memory = common.memory;
    options.replace = common.force;
    latent::remove_temporaries_on_signals();
    const auto report = latent::convert::convert(options, cli::progress(common, "printing"));
    if (!report) return cli::fail(report.error());
    if (report->damaged() > 0) cli::warn(fmt::format("{} pixels were not numbers", report->damaged()));
    return cli::print_report(common.json ? latent::convert::to_json(*report) : latent::convert::to_text(*report),
                             report->damaged() > 0 ? cli::kDoneWithLosses : cli::kDone);
} catch (...) {
    return latent::cli::fail_with_exception();
}
