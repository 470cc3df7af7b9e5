// latent-develop: records become pixels: linear XYZ, or a spectrum per pixel.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/cli.h"
#include "base/parse.h"
#include "base/temporary_path.h"
#include "sampledb/data/parse.h"
#include "tools/develop/picture.h"
#include "tools/develop/report.h"
#include "tools/develop/splat.h"

namespace {

using namespace latent;

constexpr const char* kExamples = R"(
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

Observers (default cie1931):
  cie1931, cie1964, cie2015-2, cie2015-10
  FILE.csv                 wavelength in nm, then three responses or one

Examples:
  latent-develop night.latent --size 2048 -o night.exr
      a picture 2048 pixels wide
  latent-develop night.latent --size 32768 --memory 512M --mipmap -o wall.exr
      a very large picture, with smaller levels
  latent-develop night.latent --size 32768 --crop 0,0,512,512 -o corner.exr
      a corner of it, with the same pixels
  latent-develop night.latent --size 2048 --observer cie2015-10 -o other.exr
      another observer, for spectral records
  latent-develop parts/ --size 1024 --samples 0:1048576 -o preview.exr
      a preview from some of the samples, before the parts are merged

Exit status: 0 done; 1 failed, no output; 2 wrong usage; 3 done, but damaged,
foreign, missing or non-finite input was left out, or the report could not be
written.)";

}  // namespace

int main(int argc, char** argv) try {
    develop::PictureOptions options;
    cli::CommonOptions common;
    CLI::App app{"Develop raw samples into an EXR picture of linear XYZ pixels.", "latent-develop"};
    app.footer(kExamples);
    app.add_option("FILE", options.inputs, "files of one job, or folders of files")->required();
    app.add_option("-o,--output", options.output, "picture to write")->required()->check(cli::ends_in(".exr"));
    app.add_option(
           "--size", options.size,
           "size of the whole picture in pixels; W alone keeps the film's aspect (default: the largest with 16 samples per pixel)")
        ->type_name("W|WxH");
    const auto crop = [](const std::string& text) {
        return parse_crop(text).map([](const auto& c) { return develop::PixelRect{c[0], c[1], c[2], c[3]}; });
    };
    cli::add_parsed(app, "--crop", options.crop, crop, "pixels to develop, X1 and Y1 exclusive")->type_name("X0,Y0,X1,Y1");
    app.add_option("--filter", options.filter, "pixel filter; see below")->capture_default_str()->type_name("NAME[:params]");
    auto* observer =
        app.add_option("--observer", options.observer, "observer or sensor whose response curves are applied; see below")
            ->type_name("NAME|FILE.csv");
    cli::add_parsed(app, "--samples", options.samples, sampledb::parse_sample_range, "samples to use, A to B-1 (default: all)")
        ->type_name("A:B");
    app.add_option("--image", options.image, "camera image, light image, or both (the picture is their sum)")
        ->check(CLI::IsMember({"both", "camera", "light"}))
        ->capture_default_str();
    app.add_flag("--mipmap", options.mipmap, "also store smaller levels, whose pixels are means of those they cover");
    cli::add_count(app, "--spectral-bins", options.spectral_bins,
                   "number of bins from 360 to 830 nm to store instead of XYZ, as radiance per nm", 1, 470)
        ->excludes(observer);
    cli::add_choice<bool>(app, "--compression", options.zip, {{"none", false}, {"zip", true}}, "compression of the EXR file");
    app.add_option("--simd", options.simd, "instruction set; makes no difference to pixels")
        ->capture_default_str()
        ->type_name(fmt::format("best|{}", fmt::join(develop::simd_levels(), "|")));
    app.add_flag("--skip-duplicates", options.skip_duplicates, "accept files that hold the same samples; each sample is used once");
    cli::add_parsed(app, "--job", options.job, sampledb::parse_job_id,
                    "job to develop, if folders hold several (32 hexadecimal digits)")
        ->type_name("ID");
    cli::add_common(app, common, true);
    if (const auto done = cli::parse(app, argc, argv)) return *done;

    options.replace = common.force;
    options.memory = common.memory;
    options.threads = common.threads;

    remove_temporaries_on_signals();
    const Result<develop::PictureReport> report = develop::develop_picture(options, cli::progress(common, "developing"));
    if (!report) return cli::fail(report.error());
    for (const std::string& note : report->gathering.notes) cli::note(note);
    for (const std::string& warning : report->warnings) cli::warn(warning);
    for (const std::string& loss : develop::losses(*report)) cli::warn(loss);
    return cli::print_report(common.json ? develop::to_json(*report) : develop::to_text(*report),
                             report->has_losses() ? cli::kDoneWithLosses : cli::kDone);
} catch (...) {
    return latent::cli::fail_with_exception();
}
