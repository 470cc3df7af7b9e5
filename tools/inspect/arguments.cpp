#include "tools/inspect/arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "base/cli.h"
#include "sampledb/data/parse.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

// "3:2" -> 3, 2.
Result<Aspect> parse_aspect(const std::string& text) {
    Aspect aspect;
    const char* const end = text.data() + text.size();
    const auto width = std::from_chars(text.data(), end, aspect.width);
    const bool colon = width.ec == std::errc() && width.ptr != end && *width.ptr == ':';
    const auto height = colon ? std::from_chars(width.ptr + 1, end, aspect.height) : width;
    if (!colon || height.ec != std::errc() || height.ptr != end || aspect.width == 0 || aspect.height == 0) {
        return Error{ErrorCode::kUsage, fmt::format("'{}' is no aspect; say 3:2", text)};
    }
    return aspect;
}

// "0.4,0.4,0.6,0.6": a part of the film, not empty.
Result<std::array<double, 4>> parse_region(const std::string& text) {
    std::array<double, 4> region{};
    const char *at = text.data(), *const end = at + text.size();
    for (std::size_t i = 0; i < 4; ++i) {
        const auto [stop, error] = std::from_chars(at, end, region[i]);
        const bool good = error == std::errc() && (i < 3 ? stop != end && *stop == ',' : stop == end);
        if (!good) return Error{ErrorCode::kUsage, fmt::format("'{}' is no region; say 0.4,0.4,0.6,0.6", text)};
        at = stop + 1;
    }
    const auto& [u0, v0, u1, v1] = region;
    if (0 <= u0 && u0 < u1 && u1 <= 1 && 0 <= v0 && v0 < v1 && v1 <= 1) return region;
    return Error{ErrorCode::kUsage,
                 fmt::format("'{}' is no region of the film: wants 0 <= U0 < U1 <= 1 and 0 <= V0 < V1 <= 1", text)};
}

// An option that takes one of a few words; the first of them is the default.
template <class Value>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Value& value,
                        const std::vector<std::pair<std::string, Value>>& choices, const std::string& help) {
    std::vector<std::string> words;
    for (const auto& choice : choices) words.push_back(choice.first);
    const auto take = [&value, choices](const std::string& word) {
        value = std::ranges::find(choices, word, &std::pair<std::string, Value>::first)->second;
    };
    return app.add_option_function<std::string>(name, take, help)->check(CLI::IsMember(words))->default_str(words.front());
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
    cat.add_option("--limit", options.limit, "at most this many records")->check(cli::whole_number());
    add_choice<TextFormat>(cat, "--format", options.format, {{"csv", TextFormat::kCsv}, {"json", TextFormat::kJsonLines}},
                           "csv, or one JSON object a line");
}

void add_gen_options(CLI::App& gen, GenOptions& options) {
    SyntheticScene& scene = options.scene;
    gen.add_option("-o,--output", options.output, "the new file")->required()->check(cli::ends_in(".latent"));
    cli::add_parsed(gen, "--records", options.records, parse_count, "camera records; K, M and G are powers of 1000")
        ->type_name("COUNT")
        ->default_str("1M");
    add_choice<RecordKind>(gen, "--kind", scene.kind, {{"xyz", RecordKind::kXyz}, {"spectral", RecordKind::kSpectral}},
                           "what a record stores");
    gen.add_option("--wavelengths", scene.batch, "spectral: wavelengths of a sample")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    gen.add_option("--light", scene.light_records, "light records per camera record")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str();
    gen.add_option("--single", scene.single_wavelengths, "spectral: share of records that keep one wavelength")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    add_choice<Texture>(gen, "--texture", scene.texture,
                        {{"textured", Texture::kTextured}, {"uniform", Texture::kUniform}, {"black", Texture::kBlack}},
                        "textured; uniform: every record is 1; black: every record is 0");
    cli::add_parsed(gen, "--aspect", scene.aspect, parse_aspect, "of the film")->type_name("W:H")->default_str("1:1");
    gen.add_option("--first", options.first, "first sample number, a multiple of the run length")
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
    cli::add_duration(gen, "--checkpoint", options.checkpoint_seconds, "commit finished work at least this often, above 0")
        ->default_str("60s");
    gen.add_flag("--random-positions", scene.random_positions, "stored positions instead of derived ones");
    gen.add_flag("--explicit-wavelengths", scene.explicit_wavelengths, "stored wavelengths instead of derived ones");
}

}  // namespace latent::inspect
