// latent-convert: from developed pixels to a print.
#include <fmt/format.h>

#include <array>
#include <charconv>

#include "base/cli.h"
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

// What is wrong with `text`, if it is not a number of the range: CLI::Range would let NaN pass.
std::string check_number(const std::string& text, double least, double most, const char* range) {
    double value = 0;
    const bool good = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
    return good ? std::string() : fmt::format("{}: should be a number {}", text, range);
}

latent::Result<latent::image::Rect> parse_crop(const std::string& text) {
    std::array<int, 4> c;
    const char *at = text.data(), *end = at + text.size();
    for (std::size_t i = 0; i < 4; ++i) {
        const auto [next, error] = std::from_chars(at, end, c[i]);
        if (error != std::errc{} || (i < 3 ? next == end || *next != ',' : next != end))
            return latent::Error{latent::ErrorCode::kUsage, text + ": give X0,Y0,X1,Y1 in pixels, the end exclusive"};
        at = next + 1;
    }
    return latent::image::Rect{c[0], c[1], c[2], c[3]};
}

void add_options(CLI::App& app, latent::convert::ConvertOptions& options) {
    using latent::convert::Depth;
    app.add_option("IMAGE", options.input, "EXR from latent-develop, or of linear RGB")->required();
    app.add_option("-o,--output", options.outputs, "what to write; may repeat")
        ->required()
        ->allow_extra_args(false)
        ->type_name("FILE");
    auto* sensitivity = app.add_option("-s,--sensitivity", options.sensitivity, "sensitivity of the film: Y = 1/S prints at half");
    sensitivity->check(CLI::Validator([](const std::string& s) { return check_number(s, 0x1p-512, 0x1p512, "above 0"); }, ""));
    app.add_option("--stops", options.stops, "push the sensitivity by so many stops")
        ->check(CLI::Validator([](const std::string& s) { return check_number(s, -100, 100, "from -100 to 100"); }, ""))
        ->type_name("EV");
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
    app.add_option("--luminance-row", options.luminance_row, "luminances of the primaries, instead of the profile's")
        ->type_name("R,G,B")
        ->delimiter(',');
    const auto depth = [&options](const std::string& text) {
        options.depth = text == "8" ? Depth::k8 : text == "16" ? Depth::k16 : Depth::kFloat;
    };
    app.add_option_function<std::string>("--bits", depth, "8 by default, but float for EXR, where 16 means half")
        ->check(CLI::IsMember({"8", "16", "float"}));
    app.add_flag("--dither,!--no-dither", options.dither, "hide the steps of 8 bits in noise (default on)");
    latent::cli::add_parsed(app, "--crop", options.crop, parse_crop, "only these pixels, ends exclusive")->type_name("X0,Y0,X1,Y1");
    app.add_option("--level", options.level, "mip level of the input: 1 is half its size, ...")->check(CLI::Range(0, 31));
    app.add_option("--dpi", options.dpi, "pixels per inch on paper, as TIFF, PNG, JPEG and EXR say it; changes no pixel")
        ->check(CLI::Range(1, 65535))
        ->capture_default_str();
    app.add_option("--quality", options.quality, "of JPEG and Deep Zoom's tiles")->check(CLI::Range(1, 100))->capture_default_str();
    app.add_option("--compression", options.png_level, "of PNG and TIFF; 9: small")->check(CLI::Range(1, 9))->capture_default_str();
    app.add_flag("--tiles", options.tiles, "TIFF in tiles of 256 x 256");
    app.add_flag("--pyramid", options.pyramid, "TIFF with smaller and smaller copies, in tiles");
    app.add_flag("--png-tiles", options.png_tiles, "Deep Zoom in PNG instead of JPEG");
    app.add_option("--overlap", options.overlap,
                   "pixels of its neighbours around each tile of Deep Zoom; 0 is for other viewers than NAME.html")
        ->check(CLI::Range(0, 1))
        ->capture_default_str();
    app.footer(kExamples);
}

}  // namespace

int main(int argc, char** argv) {
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
    const auto report = latent::convert::convert(options, cli::progress_to_stderr("printing"));
    if (!report) return cli::fail(report.error());
    if (report->damaged() > 0) cli::warn(fmt::format("{} pixels were not numbers", report->damaged()));
    return cli::print_report(common.json ? latent::convert::to_json(*report) : latent::convert::to_text(*report),
                             report->damaged() > 0 ? cli::kDoneWithLosses : cli::kDone);
}
