#include "render/program/job.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/size.h"
#include "render/program/make_integrator.h"
#include "render/program/more_than.h"
#include "render/program/simd.h"
#include "render/scene/canonical.h"

namespace latent::render {

namespace {

using sampledb::RecordKind;

// Raw bytes that a sample takes at least, so that S brings runs near their size: one camera record, and for bdpt as much again.
std::uint64_t bytes_per_sample(const IntegratorSettings& settings, bool splits_wavelengths) {
    std::uint64_t fixed = 8 + 1 + 8 + 4;
    for (const sampledb::ExtraColumnSpec& column : aov_columns(settings.aovs)) fixed += sampledb::width(column.type);
    if (splits_wavelengths)  // a camera record for each
        return settings.batch * (fixed + (settings.record == RecordKind::kXyz ? 12 : 2 + 4 + 2 + 4));
    const std::uint64_t record = fixed + (settings.record == RecordKind::kXyz ? 12 : 2 + 4 + 2 + 4 * std::uint64_t{settings.batch});
    return settings.kind == IntegratorKind::kBdpt ? 2 * record : record;
}

// Shifts of the film positions: none for seed 0.
sampledb::PositionSamplerSpec positions_of(sampledb::PositionSampler sampler, std::uint64_t seed, const Resolution& pixels) {
    sampledb::PositionSamplerSpec spec{sampler};
    if (sampler == sampledb::PositionSampler::kPixels) spec.width = pixels.width, spec.height = pixels.height;
    if (seed == 0) return spec;
    std::byte bytes[8];
    store_le(bytes, seed);
    const std::uint64_t hash = hash64(bytes);
    spec.shift_u = static_cast<std::uint32_t>(hash);
    spec.shift_v = static_cast<std::uint32_t>(hash >> 32);
    return spec;
}

IntegratorSettings integrator_settings(const RenderSettings& settings, const SceneDescription& scene) {
    IntegratorSettings out;
    out.kind = settings.integrator.value_or(scene.integrator == "bdpt" ? IntegratorKind::kBdpt : IntegratorKind::kPath);
    out.connections = settings.connections;
    out.max_depth = settings.max_depth.value_or(scene.max_depth);
    out.batch = settings.wavelengths;
    out.record = settings.record;
    const Resolution pixels = settings.resolution.value_or(Resolution{scene.film.width, scene.film.height});
    out.positions = positions_of(settings.sampler, settings.seed, pixels);
    out.seed = settings.seed;
    out.aovs = settings.aovs;
    out.textures = {settings.texture_cache, pixels.width, pixels.height};
    return out;
}

Status check_aovs(const AovSettings& aovs, const SceneDescription& scene) {
    if (aovs.lens && !(scene.camera.lens_radius > 0))
        return usage_error("--aov lens: the camera of this scene has no lens; give a perspective camera a lens radius");
    if (aovs.time && (!has_motion(scene) || scene.shutter.open == scene.shutter.close))
        return usage_error("--aov time: nothing moves in this scene while the shutter is open");
    return {};
}

// Marks fields that few jobs have: no other field has a value as large.
constexpr std::uint64_t kAovTag = 0x616f760000000000;  // "aov"

// The hash of everything that decides what a sample number's records are, and how they are cut into runs.
sampledb::JobId job_id(const Hash128& content, const SceneDescription& scene, const IntegratorSettings& settings,
                       const Integrator& integrator, const sampledb::Job& job) {
    Bytes bytes;
    ByteWriter writer(bytes);
    for (const std::uint64_t field :
         {std::uint64_t{kRenderEpoch}, content.low, content.high, std::uint64_t{job.aspect_width}, std::uint64_t{job.aspect_height},
          static_cast<std::uint64_t>(settings.kind),
          settings.kind == IntegratorKind::kBdpt ? static_cast<std::uint64_t>(settings.connections) : 0,
          std::uint64_t{settings.max_depth}, settings.seed, static_cast<std::uint64_t>(job.positions.sampler),
          std::uint64_t{job.positions.width}, std::uint64_t{job.positions.height}, static_cast<std::uint64_t>(job.kind),
          std::uint64_t{settings.batch}, std::uint64_t{job.precision}, std::uint64_t{job.run_samples}, job.run_bytes}) {
        writer.put(field);
    }
    if (settings.light_groups.any()) writer.put(std::uint64_t{settings.light_groups.count});
    if (settings.aovs.any()) writer.put(kAovTag | settings.aovs.mask());
    if (!scene.textures.empty()) {  // which are filtered by pixels
        writer.put(std::uint64_t{settings.textures.width});
        writer.put(std::uint64_t{settings.textures.height});
    }
    for (const sampledb::WavelengthDensity::Knot& knot : integrator.density().knots()) {
        writer.put(knot.lambda);
        writer.put(knot.cumulative);
    }
    return hash128(bytes);
}

// The samples of all shards.
Result<sampledb::SampleRange> range_of(const RenderSettings& settings, const Resolution& pixels, const sampledb::Job& job) {
    const double count = std::ceil(settings.spp * pixels.width * pixels.height);
    if (!settings.samples && count >= 0x1p62)
        return usage_error(fmt::format("--spp {}: too large; a job has fewer than 2^62 samples", settings.spp));
    if (!settings.samples && !(count >= 1)) return usage_error(fmt::format("--spp {}: not a number of samples", settings.spp));
    sampledb::SampleRange all = settings.samples.value_or(sampledb::SampleRange{0, static_cast<std::uint64_t>(count)});
    if (!settings.more_than.empty()) {
        const Result<std::uint64_t> end = end_of_samples(settings.more_than, settings.output, job);
        if (!end) return end.error();
        if (*end >= all.end)
            return usage_error(
                fmt::format("--spp {}: makes samples 0:{}, and the files of --more-than go to {}; use a larger --spp", settings.spp,
                            all.end, *end));
        all.first = *end;
    }
    if (all.empty()) return usage_error(fmt::format("--samples {}:{}: is empty", all.first, all.end));
    return all;
}

// How many intervals of `run_samples` the range touches: its runs begin and end at their boundaries, and at its own.
std::uint64_t runs_of(const sampledb::SampleRange& all, std::uint32_t run_samples) {
    return all.empty() ? 0 : (all.end - 1) / run_samples - all.first / run_samples + 1;
}

// What to say if there are fewer runs than shards, so that some have nothing to do.
std::string too_few_runs(const sampledb::SampleRange& all, const Shard& shard, std::uint32_t run_samples) {
    const std::uint64_t runs = runs_of(all, run_samples);
    std::uint32_t shorter = run_samples;
    while (shorter > sampledb::kMinRunSamples && runs_of(all, shorter) < shard.count) shorter /= 2;
    const std::string advice = runs_of(all, shorter) >= shard.count
                                   ? fmt::format("; use --run-samples {} for every shard to give each some work", shorter)
                                   : "";
    return fmt::format(
        "--shard {}/{}: {} of {} shards are empty{}: {} samples make only {} of up to {}, and runs are not divided{}", shard.index,
        shard.count, shard.count - runs, shard.count, shard_of(all, shard, run_samples).empty() ? ", including this one" : "",
        all.size(), counted(runs, "run"), run_samples, advice);
}

// What to say of pixels whose shape is not that of the film, to within the rounding of one side; empty if it is.
std::string other_shape(const Resolution& pixels, const FilmDescription& film) {
    const double aspect = static_cast<double>(film.width) / film.height;
    if (std::abs(pixels.width - pixels.height * aspect) < 1 || std::abs(pixels.height - pixels.width / aspect) < 1) return "";
    const std::uint32_t divisor = std::gcd(film.width, film.height);
    return fmt::format(
        "--resolution {}x{}: the picture keeps the shape of the scene's film, {}:{}, neither stretched nor cropped; only the "
        "samples and the filtering of textures follow --resolution",
        pixels.width, pixels.height, film.width / divisor, film.height / divisor);
}

}  // namespace

sampledb::SampleRange shard_of(const sampledb::SampleRange& all, const Shard& shard, std::uint32_t run_samples) {
    const std::uint64_t runs = runs_of(all, run_samples);
    // floor(runs i / count) without overflow
    const auto boundary = [&](std::uint64_t i) {
        const std::uint64_t run = runs / shard.count * i + runs % shard.count * i / shard.count;
        return run == 0 ? all.first : run >= runs ? all.end : (all.first / run_samples + run) * run_samples;
    };
    return {boundary(shard.index), boundary(shard.index + 1)};
}

Result<std::unique_ptr<RenderJob>> prepare(const RenderSettings& settings) {
    auto out = std::make_unique<RenderJob>();
    Result<std::string> simd = choose_simd(settings.simd);
    if (!simd) return simd.error();
    ModelOptions model = settings.model;
    if (settings.resolution) model.aspect = static_cast<double>(settings.resolution->width) / settings.resolution->height;
    Result<LoadedScene> scene =
        load_scene(settings.scene, settings.integrator.has_value(), settings.rgb_spectra, model, settings.additions);
    if (!scene) return scene.error();
    if (settings.strict && !scene->warnings.empty())
        return Error{ErrorCode::kUnsupported,
                     fmt::format("{}: refused because of --strict\n{}", settings.scene.string(), fmt::join(scene->warnings, "\n"))};
    out->scene = std::move(*scene);
    if (settings.light_groups) {
        Result<std::vector<std::string>> names = group_lights(out->scene.description);
        if (!names) return names.error();
        out->light_groups = std::move(*names);
    }
    const Hash128 content = make_canonical(out->scene.description);
    const SceneDescription& description = out->scene.description;
    out->settings = integrator_settings(settings, description);
    out->settings.simd = std::move(*simd);
    if (settings.light_groups) out->settings.light_groups = groups_of(description, out->light_groups.size());
    const IntegratorSettings& integrator_options = out->settings;
    if (const Status possible = check_aovs(settings.aovs, description); !possible) return possible.error();
    out->raw_sample_bytes =
        bytes_per_sample(integrator_options, description.camera.focal_slope != 0 && description.camera.lens_radius > 0);
    Result<std::unique_ptr<Integrator>> integrator = make_integrator(description, integrator_options);
    if (!integrator) return integrator.error();
    out->integrator = std::move(*integrator);

    sampledb::Job& job = out->job;
    const std::uint32_t divisor = std::gcd(description.film.width, description.film.height);
    job.aspect_width = description.film.width / divisor;
    job.aspect_height = description.film.height / divisor;
    job.kind = settings.record;
    if (job.kind == RecordKind::kSpectral) {
        job.batch = static_cast<std::uint16_t>(settings.wavelengths);
        job.density = out->integrator->density();
    }
    job.precision = static_cast<std::uint8_t>(settings.precision);
    job.light_paths_per_sample = out->integrator->light_paths_per_sample();
    job.run_samples = settings.run_samples != 0 ? settings.run_samples : sampledb::default_run_samples(out->raw_sample_bytes);
    job.positions = integrator_options.positions;
    if (settings.light_groups) job.extra = {{kLightGroupColumn, sampledb::ColumnType::kU8}};
    for (sampledb::ExtraColumnSpec& column : aov_columns(settings.aovs)) job.extra.push_back(std::move(column));
    job.id = job_id(content, description, integrator_options, *out->integrator, job);
    if (const Status valid = job.validate(); !valid) return usage_error(valid.error().message);

    out->resolution = settings.resolution.value_or(Resolution{description.film.width, description.film.height});
    const Result<sampledb::SampleRange> all = range_of(settings, out->resolution, job);
    if (!all) return all.error();
    out->all = *all;
    out->range = shard_of(*all, settings.shard, job.run_samples);
    out->warnings = out->scene.notes;
    out->warnings.insert(out->warnings.end(), out->scene.warnings.begin(), out->scene.warnings.end());
    for (std::string& warning : out->integrator->warnings()) out->warnings.push_back(std::move(warning));
    if (std::string shape = other_shape(out->resolution, description.film); !shape.empty())
        out->warnings.push_back(std::move(shape));
    if (runs_of(*all, job.run_samples) < settings.shard.count)
        out->warnings.push_back(too_few_runs(*all, settings.shard, job.run_samples));
    return out;
}

std::vector<std::string> later_warnings(const RenderJob& job) {
    std::vector<std::string> all = job.integrator->warnings();
    std::erase_if(all, [&](const std::string& warning) { return std::ranges::count(job.warnings, warning) > 0; });
    return all;
}

}  // namespace latent::render
