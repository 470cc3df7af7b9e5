#include "tools/inspect/arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/cli.h"
#include "base/size.h"
#include "sampledb/parse.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

// "3:2" -> 3, 2.
Status parse_aspect(const std::string& text, SyntheticScene& scene) {
    const char* const end = text.data() + text.size();
    const auto width = std::from_chars(text.data(), end, scene.aspect_width);
    const bool colon = width.ec == std::errc() && width.ptr != end && *width.ptr == ':';
    const auto height = colon ? std::from_chars(width.ptr + 1, end, scene.aspect_height) : width;
    if (!colon || height.ec != std::errc() || height.ptr != end || scene.aspect_width == 0 || scene.aspect_height == 0) {
        return Error{ErrorCode::kUsage, fmt::format("--aspect: '{}' is no aspect; say 3:2", text)};
    }
    return {};
}

}  // namespace

Status TextArguments::apply(CatOptions& cat, GenOptions& gen) const {
    if (!samples.empty()) {
        const Result<SampleRange> range = parse_sample_range(samples);
        if (!range) return range.error().at("--samples");
        cat.samples = *range;
    }
    if (region.size() == 4) cat.region = {region[0], region[1], region[2], region[3]};
    cat.format = format == "csv" ? TextFormat::kCsv : TextFormat::kJsonLines;

    const Result<std::uint64_t> count = parse_count(records);
    if (!count) return count.error().at("--records");
    if (*count > (~std::uint64_t{0} - first) / gen.scene.every)
        return Error{ErrorCode::kUsage, "--records: beyond the last sample number"};
    gen.samples = {first, first + *count * gen.scene.every};
    gen.scene.kind = kind == "xyz" ? RecordKind::kXyz : RecordKind::kSpectral;
    gen.scene.texture = texture == "uniform" ? Texture::kUniform : texture == "black" ? Texture::kBlack : Texture::kTextured;
    return parse_aspect(aspect, gen.scene);
}

void add_cat_options(CLI::App& cat, CatOptions& options, TextArguments& text) {
    cat.add_option("FILE", options.inputs, "files of one job, or folders")->required();
    cat.add_option("--samples", text.samples, "only sample numbers A .. B-1")->type_name("A:B");
    cat.add_option("--region", text.region, "only this part of the film, in [0,1]")
        ->type_name("U0,V0,U1,V1")
        ->delimiter(',')
        ->expected(4);
    cat.add_option("--limit", options.limit, "at most this many records")->check(cli::whole_number());
    cat.add_option("--format", text.format, "csv, or one JSON object a line")
        ->check(CLI::IsMember({"csv", "json"}))
        ->capture_default_str();
}

void add_gen_options(CLI::App& gen, GenOptions& options, TextArguments& text) {
    SyntheticScene& scene = options.scene;
    gen.add_option("-o,--output", options.output, "the new file")->required()->check(cli::ends_in(".latent"));
    gen.add_option("--records", text.records, "camera records; K, M and G are powers of 1000")
        ->type_name("COUNT")
        ->capture_default_str();
    gen.add_option("--kind", text.kind, "what a record stores")->check(CLI::IsMember({"xyz", "spectral"}))->capture_default_str();
    gen.add_option("--wavelengths", scene.batch, "spectral: wavelengths of a sample")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    gen.add_option("--light", scene.light_records, "light records per camera record")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str();
    gen.add_option("--single", scene.single_wavelengths, "spectral: share of records that keep one wavelength")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    gen.add_option("--texture", text.texture, "textured; uniform: every record is 1; black: every record is 0")
        ->check(CLI::IsMember({"textured", "uniform", "black"}))
        ->capture_default_str();
    gen.add_option("--aspect", text.aspect, "of the film")->type_name("W:H")->capture_default_str();
    gen.add_option("--first", text.first, "first sample number, a multiple of the run length")
        ->check(cli::whole_number())
        ->capture_default_str();
    gen.add_option("--every", scene.every, "only sample numbers divisible by this have records")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 40))
        ->capture_default_str();
    gen.add_option("--seed", scene.seed, "another seed, another job")->check(cli::whole_number())->capture_default_str();
    gen.add_option("--run-samples", scene.run_samples, "samples of a run, a power of two; 0: near 64 MiB")
        ->check(cli::whole_number())
        ->capture_default_str();
    cli::add_size(gen, "--run-bytes", scene.run_bytes, "cap of a run")->default_str("256M");
    cli::add_duration(gen, "--checkpoint", options.checkpoint_seconds, "commit finished work at least this often")
        ->default_str("60s");
    gen.add_flag("--random-positions", scene.random_positions, "stored positions instead of derived ones");
    gen.add_flag("--explicit-wavelengths", scene.explicit_wavelengths, "stored wavelengths instead of derived ones");
}

}  // namespace latent::inspect
