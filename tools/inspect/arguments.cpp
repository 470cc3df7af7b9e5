#include "tools/inspect/arguments.h"

#include <fmt/format.h>

#include <array>
#include <limits>

#include "base/cli.h"
#include "base/memory.h"
#include "base/parse.h"
#include "sampledb/data/parse.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

// "3:2" -> 3, 2.
Result<Aspect> parse_aspect(const std::string& text) {
    constexpr std::uint64_t kMax = std::numeric_limits<std::uint32_t>::max();
    const auto sides = parse_pair(text, ':');
    if (sides && sides->first > 0 && sides->second > 0 && sides->first <= kMax && sides->second <= kMax)
        return Aspect{static_cast<std::uint32_t>(sides->first), static_cast<std::uint32_t>(sides->second)};
    return is_not(text, "an aspect (try 3:2)");
}

// "0.4,0.4,0.6,0.6": a part of the film, not empty.
Result<std::array<double, 4>> parse_region(const std::string& text) {
    const auto numbers = parse_numbers(text);
    if (numbers && numbers->size() == 4) {
        const double u0 = (*numbers)[0], v0 = (*numbers)[1], u1 = (*numbers)[2], v1 = (*numbers)[3];
        if (0 <= u0 && u0 < u1 && u1 <= 1 && 0 <= v0 && v0 < v1 && v1 <= 1) return std::array{u0, v0, u1, v1};
    }
    return is_not(text, "a part of the film U0,V0,U1,V1, between 0 and 1 (try 0.4,0.4,0.6,0.6)");
}

}  // namespace

void add_cat_options(CLI::App& cat, CatOptions& options) {
    cat.add_option("FILE", options.inputs, "files of one job, their http(s) URLs, or folders of files")->required();
    cli::add_parsed(cat, "--samples", options.samples, parse_sample_range, "samples to print, A to B-1 (default: all)")
        ->type_name("A:B");
    cli::add_parsed(cat, "--region", options.region, parse_region,
                    "part of the film to print, in coordinates from 0 to 1 (default: all)")
        ->type_name("U0,V0,U1,V1");
    cli::add_parsed(cat, "--job", options.job, parse_job_id, "job to print, if folders hold several (32 hexadecimal digits)")
        ->type_name("ID");
    cli::add_memory(cat, options.memory, "memory limit");
    cli::add_count(cat, "--limit", options.limit, "maximum number of records to print");
    cli::add_choice<CatFormat>(cat, "--format", options.format,
                               {{"csv", CatFormat::kCsv}, {"json", CatFormat::kJsonLines}, {"npy", CatFormat::kNpy}},
                               "CSV, one JSON object per line, or a NumPy array");
    cat.add_option("--columns", options.columns, "columns of a NumPy array, separated by commas (default: all)")
        ->delimiter(',')
        ->type_name("NAME,...")
        ->allow_extra_args(false);
}

void add_noise_options(CLI::App& noise, NoiseOptions& options) {
    develop::PictureOptions& picture = options.picture;
    noise.add_option("FILE", picture.inputs, "files of one job, their http(s) URLs, or folders of files")->required();
    noise.add_flag("--skip-duplicates", picture.skip_duplicates,
                   "accept files that hold the same samples; each sample is used once");
    noise
        .add_option(
            "--size", picture.size,
            "size of the whole picture in pixels; W alone keeps the film's aspect (default: what the file was rendered for)")
        ->type_name("W|WxH");
    cli::add_crop(noise, picture.crop, "pixels to look at, X1 and Y1 exclusive (default: all)");
    noise.add_option("--observer", picture.observer.name, "observer or camera that sees the picture, as for latent-develop")
        ->type_name("NAME|FILE.csv");
    cli::add_parsed(noise, "--samples", picture.samples, parse_sample_range, "samples to use, A to B-1 (default: all)")
        ->type_name("A:B");
    cli::add_parsed(noise, "--job", picture.job, parse_job_id, "job to look at, if folders hold several (32 hexadecimal digits)")
        ->type_name("ID");
    picture.memory = default_memory();
    cli::add_memory(noise, picture.memory, "memory limit");
    const auto map = [](const std::string& name) -> Result<std::filesystem::path> {
        const std::filesystem::path path = name;
        if (path.extension() == ".png" || path.extension() == ".exr") return path;
        return is_not(name, "a picture file (try noise.png, or noise.exr)");
    };
    cli::add_parsed(noise, "-o,--output", options.map, map, "map of the noise to write")->type_name("NAME.png|NAME.exr");
}

void add_gen_options(CLI::App& gen, GenOptions& options) {
    SyntheticScene& scene = options.scene;
    gen.add_option("-o,--output", options.output, "file to write")->required()->check(cli::ends_in(".latent"));
    cli::add_count(gen, "--records", options.records, "number of camera records");
    cli::add_choice<RecordKind>(gen, "--kind", scene.kind, {{"xyz", RecordKind::kXyz}, {"spectral", RecordKind::kSpectral}},
                                "contents of a record: XYZ, or a value for each wavelength");
    cli::add_count<std::uint16_t>(gen, "--wavelengths", scene.batch, "wavelengths per sample, if spectral", 1, 1024);
    cli::add_number(gen, "--light", scene.light_records, "light records per camera record", 0, 1000);
    cli::add_number(gen, "--single", scene.single_wavelengths, "fraction of records with one wavelength, if spectral", 0, 1);
    cli::add_choice<Subject>(gen, "--texture", scene.subject,
                             {{"textured", Subject::kTextured}, {"uniform", Subject::kUniform}, {"black", Subject::kBlack}},
                             "values of the records: a texture, 1 everywhere, or 0 everywhere");
    cli::add_parsed(gen, "--aspect", scene.aspect, parse_aspect, "aspect ratio of the film")->type_name("W:H")->default_str("1:1");
    cli::add_count(gen, "--first", options.first, "first sample number, preferably a multiple of the run length");
    cli::add_count<std::uint64_t>(gen, "--every", scene.every, "spacing of sample numbers: only multiples of this have records", 1,
                                  std::uint64_t{1} << 40);
    cli::add_count<std::uint8_t>(gen, "--precision", scene.precision, "mantissa bits of each stored value; 23 keeps all", 1,
                                 kFullPrecision);
    cli::add_count(gen, "--seed", scene.seed, "random seed; each seed is a separate job");
    cli::add_count(gen, "--run-samples", scene.run_samples, "samples per run, a power of two; 0: runs of about 64 MiB");
    cli::add_size(gen, "--run-bytes", scene.run_bytes, "maximum size of a run in memory")->default_str("256M");
    cli::add_duration(gen, "--checkpoint", options.checkpoint_seconds, "interval at which finished work is committed to disk")
        ->default_str("60s");
    gen.add_flag("--random-positions", scene.random_positions, "random positions, stored instead of derived");
    gen.add_flag("--explicit-wavelengths", scene.explicit_wavelengths, "wavelengths stored instead of derived");
}

}  // namespace latent::inspect
