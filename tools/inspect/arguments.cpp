#include "tools/inspect/arguments.h"

#include <fmt/format.h>

#include <array>
#include <limits>

#include "base/cli.h"
#include "base/parse.h"
#include "sampledb/data/parse.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

// "3:2" -> 3, 2.
Result<Aspect> parse_aspect(const std::string& text) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    const auto sides = parse_pair(text, ':');
    if (sides && sides->first > 0 && sides->second > 0 && sides->first <= kMost && sides->second <= kMost)
        return Aspect{static_cast<std::uint32_t>(sides->first), static_cast<std::uint32_t>(sides->second)};
    return Error{ErrorCode::kUsage, fmt::format("'{}' is not an aspect (try 3:2)", text)};
}

// "0.4,0.4,0.6,0.6": a part of the film, not empty.
Result<std::array<double, 4>> parse_region(const std::string& text) {
    const auto numbers = parse_numbers(text);
    if (numbers && numbers->size() == 4) {
        const double u0 = (*numbers)[0], v0 = (*numbers)[1], u1 = (*numbers)[2], v1 = (*numbers)[3];
        if (0 <= u0 && u0 < u1 && u1 <= 1 && 0 <= v0 && v0 < v1 && v1 <= 1) return std::array{u0, v0, u1, v1};
    }
    return Error{ErrorCode::kUsage,
                 fmt::format("'{}' is not a part of the film U0,V0,U1,V1, between 0 and 1 (try 0.4,0.4,0.6,0.6)", text)};
}

}  // namespace

void add_cat_options(CLI::App& cat, CatOptions& options) {
    cat.add_option("FILE", options.inputs, "files of one job, or folders")->required();
    cli::add_parsed(cat, "--samples", options.samples, parse_sample_range, "only sample numbers A .. B-1")->type_name("A:B");
    cli::add_parsed(cat, "--region", options.region, parse_region, "only this part of the film, in [0,1]")
        ->type_name("U0,V0,U1,V1");
    cli::add_parsed(cat, "--job", options.job, parse_job_id,
                    "where folders hold several jobs: the one to print (32 hexadecimal digits)")
        ->type_name("ID");
    cli::add_size(cat, "--memory", options.memory, "memory to stay within")->default_str("1G");
    cli::add_count(cat, "--limit", options.limit, "at most this many records");
    cli::add_choice<TextFormat>(cat, "--format", options.format, {{"csv", TextFormat::kCsv}, {"json", TextFormat::kJsonLines}},
                                "csv, or one JSON object a line");
}

void add_gen_options(CLI::App& gen, GenOptions& options) {
    SyntheticScene& scene = options.scene;
    gen.add_option("-o,--output", options.output, "the new file")->required()->check(cli::ends_in(".latent"));
    cli::add_count(gen, "--records", options.records, "camera records");
    cli::add_choice<RecordKind>(gen, "--kind", scene.kind, {{"xyz", RecordKind::kXyz}, {"spectral", RecordKind::kSpectral}},
                                "what a record stores");
    cli::add_count<std::uint16_t>(gen, "--wavelengths", scene.batch, "spectral: wavelengths of a sample", 1, 1024);
    cli::add_number(gen, "--light", scene.light_records, "light records per camera record", 0, 1000);
    cli::add_number(gen, "--single", scene.single_wavelengths, "spectral: share of records that keep one wavelength", 0, 1);
    cli::add_choice<Texture>(gen, "--texture", scene.texture,
                             {{"textured", Texture::kTextured}, {"uniform", Texture::kUniform}, {"black", Texture::kBlack}},
                             "textured; uniform: every record is 1; black: every record is 0");
    cli::add_parsed(gen, "--aspect", scene.aspect, parse_aspect, "of the film")->type_name("W:H")->default_str("1:1");
    cli::add_count(gen, "--first", options.first, "first sample number, a multiple of the run length");
    cli::add_count<std::uint64_t>(gen, "--every", scene.every, "only sample numbers divisible by this have records", 1,
                                  std::uint64_t{1} << 40);
    cli::add_count<std::uint8_t>(gen, "--precision", scene.precision, "mantissa bits of stored values; 23: as they are", 1,
                                 kFullPrecision);
    cli::add_count(gen, "--seed", scene.seed, "another seed, another job");
    cli::add_count(gen, "--run-samples", scene.run_samples, "samples of a run, a power of two; 0: near 64 MiB");
    cli::add_size(gen, "--run-bytes", scene.run_bytes, "cap of a run")->default_str("256M");
    cli::add_duration(gen, "--checkpoint", options.checkpoint_seconds, "commit finished work at least this often, above 0")
        ->default_str("60s");
    gen.add_flag("--random-positions", scene.random_positions, "stored positions instead of derived ones");
    gen.add_flag("--explicit-wavelengths", scene.explicit_wavelengths, "stored wavelengths instead of derived ones");
}

}  // namespace latent::inspect
