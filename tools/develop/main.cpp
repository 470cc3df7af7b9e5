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
The picture's size, filter and observer are chosen here, not when rendering: develop again for another. Pixels are linear XYZ; print
them with latent-convert. Without --size the picture gets at least 16 samples per pixel. Memory stays within --memory at any size,
and neither it nor --threads, --crop, --simd or the order of files changes a bit of any pixel.

Filters: quartic:s,R (default -3,1.5: no weight is negative; -6,2 is sharper and rings)  gaussian:sigma,R  box  mitchell:B,C
mitchell-separable:B,C  lanczos
Observers: cie1931 (default)  cie1964  cie2015-2  cie2015-10, or a CSV file: wavelength in nm, then three responses or one

Examples:
  latent-develop night.latent --size 2048 -o night.exr                           a picture 2048 pixels wide
  latent-develop night.latent --size 32768 --memory 512M --mipmap -o wall.exr    a very large one, with smaller levels
  latent-develop night.latent --size 32768 --crop 0,0,512,512 -o corner.exr      a corner of it, the same pixels
  latent-develop night.latent --size 2048 --observer cie2015-10 -o other.exr     another observer (spectral records)
  latent-develop parts/ --size 1024 --samples 0:1048576 -o preview.exr           some samples of parts not merged yet

Exit status: 0 done; 1 failed, no output; 2 wrong usage; 3 done, but something damaged, foreign, missing or not finite was
left out, or the report could not be written.)";

}  // namespace

int main(int argc, char** argv) try {
    develop::PictureOptions options;
    cli::CommonOptions common;
    CLI::App app{"Develop records into an EXR of linear XYZ.", "latent-develop"};
    app.footer(kExamples);
    app.add_option("FILE", options.inputs, "files of one job, or folders that hold them, in any order")->required();
    app.add_option("-o,--output", options.output, "the picture")->required()->check(cli::ends_in(".exr"));
    app.add_option("--size", options.size, "pixels of the whole film; W alone derives the height")->type_name("W|WxH");
    const auto crop = [](const std::string& text) {
        return parse_crop(text).map([](const auto& c) { return develop::PixelRect{c[0], c[1], c[2], c[3]}; });
    };
    cli::add_parsed(app, "--crop", options.crop, crop, "only these pixels of it, ends exclusive")->type_name("X0,Y0,X1,Y1");
    app.add_option("--filter", options.filter, "pixel filter")->capture_default_str()->type_name("NAME[:params]");
    auto* observer = app.add_option("--observer", options.observer, "who looks at the spectra")->type_name("NAME|FILE.csv");
    cli::add_parsed(app, "--samples", options.samples, sampledb::parse_sample_range, "only samples A .. B-1")->type_name("A:B");
    app.add_option("--image", options.image, "the picture, or one of the images that add up to it")
        ->check(CLI::IsMember({"both", "camera", "light"}))
        ->capture_default_str();
    app.add_flag("--mipmap", options.mipmap, "store smaller levels too, each pixel the mean of those that it covers");
    cli::add_count(app, "--spectral-bins", options.spectral_bins, "instead of XYZ: N bins of radiance per nm over 360..830 nm", 1,
                   470)
        ->excludes(observer);
    cli::add_choice<bool>(app, "--compression", options.zip, {{"none", false}, {"zip", true}}, "of the EXR");
    app.add_option("--simd", options.simd, "instructions to use")
        ->capture_default_str()
        ->type_name(fmt::format("best|{}", fmt::join(develop::simd_levels(), "|")));
    app.add_flag("--skip-duplicates", options.skip_duplicates, "count files that were named twice once, instead of refusing them");
    cli::add_parsed(app, "--job", options.job, sampledb::parse_job_id,
                    "where folders hold several jobs: the one to develop (32 hexadecimal digits)")
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
