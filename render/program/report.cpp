#include "render/program/report.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <ctime>

#include "base/hash.h"
#include "base/json.h"
#include "base/size.h"
#include "render/geometry/geometry.h"
#include "render/scene/shape_counts.h"

namespace latent::render {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const ShapeCounts& shapes) {
    return {{"triangles", shapes.triangles},
            {"patches", shapes.patches},
            {"curve_segments", shapes.curve_segments},
            {"quadrics", shapes.quadrics}};
}

std::string to_text(const ShapeCounts& shapes) {
    std::string out;
    const auto add = [&out](std::uint64_t count, const char* one, const char* several) {
        if (count > 0) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", count, count == 1 ? one : several);
    };
    add(shapes.triangles, "triangle", "triangles");
    add(shapes.patches, "curved patch", "curved patches");
    add(shapes.curve_segments, "curve segment", "curve segments");
    add(shapes.quadrics, "quadric", "quadrics");
    return out.empty() ? "no shapes" : out;
}

std::string to_text(const SceneSize& size) {
    const std::string stored = "scene: " + to_text(size.stored);
    if (size.instances == 0) return stored + "\n";
    return fmt::format("{} in memory; with {}, {}\n", stored, counted(size.instances, "instance"), to_text(size.placed));
}

}  // namespace

std::string to_text(const RadianceFaults& faults) {
    return fmt::format("{} stored as black: {} NaN, {} infinite, {} negative",
                       counted(faults.total(), "record") + (faults.total() == 1 ? " was" : " were"), faults.nan, faults.infinite,
                       faults.negative);
}

std::string to_text(const RenderReport& report, const RenderJob& job, bool json) {
    const double rate = report.seconds > 0 ? static_cast<double>(report.samples) / report.seconds : 0;
    if (json) {
        std::vector<std::string> warnings = job.warnings;
        for (std::string& met : later_warnings(job)) warnings.push_back(std::move(met));
        const Json out = {{"job", to_hex(job.job.id)},
                          {"first_sample", job.range.first},
                          {"end_sample", job.range.end},
                          {"complete", report.complete},
                          {"finished_elsewhere", report.elsewhere},
                          {"samples_rendered", report.samples},
                          {"samples_committed", report.committed},
                          {"seconds", report.seconds},
                          {"samples_per_second", rate},
                          {"shadow_rays", report.shadow_rays},
                          {"bytes_written", report.written.bytes_written},
                          {"runs_written", report.written.runs_written},
                          {"checkpoints_written", report.written.checkpoints_written},
                          {"nan", report.faults.nan},
                          {"infinite", report.faults.infinite},
                          {"negative", report.faults.negative},
                          {"warnings", warnings}};
        return json_text(out) + "\n";
    }
    std::string rendered =
        fmt::format("{} rendered in {} ({} samples/s)", report.samples, format_duration(report.seconds), format_count(rate));
    if (report.complete && report.samples == 0 && !report.elsewhere) rendered = "nothing left to render";
    if (job.range.empty()) rendered = "an empty shard";
    return fmt::format("job {}\nsamples {}:{}, {}, {} written\n{}", to_hex(job.job.id), job.range.first, job.range.end, rendered,
                       format_size(report.written.bytes_written),
                       report.elsewhere ? "another process finished this part in the meantime\n" : "");
}

std::string to_text(const Forecast& forecast, const RenderJob& job, bool json) {
    const SceneSize size = size_of(job.scene.description);
    if (json) {
        Json scene = json_of(size.stored);
        scene["instances"] = size.instances;
        scene["with_instances"] = json_of(size.placed);
        Json out = {{"job", to_hex(job.job.id)},
                    {"scene", std::move(scene)},
                    {"first_sample", job.range.first},
                    {"end_sample", job.range.end},
                    {"run_samples", job.job.run_samples},
                    {"samples", forecast.samples},
                    {"committed", forecast.committed},
                    {"bytes", forecast.bytes},
                    {"seconds", forecast.seconds},
                    {"measured_samples", forecast.measured_samples},
                    {"fits", forecast.fits()}};
        if (forecast.free_bytes) out["free_bytes"] = *forecast.free_bytes;
        return json_text(out) + "\n";
    }
    const std::string free = forecast.free_bytes ? fmt::format("; {} are free", format_size(*forecast.free_bytes)) : "";
    if (forecast.committed == forecast.samples)
        return to_text(size) + (forecast.samples == 1 ? "the only sample is already committed\n"
                                                      : fmt::format("all {} samples are already committed\n", forecast.samples));
    const std::uint64_t missing = forecast.samples - forecast.committed;
    const std::string which = forecast.committed == 0 ? counted(missing, "sample")
                                                      : fmt::format("{} of {} samples are committed; the other {}",
                                                                    forecast.committed, forecast.samples, missing);
    return fmt::format("{}{} would take {}; the finished file would be {}{} (measured on {})\n", to_text(size), which,
                       format_duration(forecast.seconds), format_size(forecast.bytes), free,
                       counted(forecast.measured_samples, "sample"));
}

namespace {

// Names by number and, as far as there is room, the spectrum that all lights of a group have, which latent-develop may replace.
Json json_of_groups(const RenderJob& job) {
    constexpr std::size_t kRoom = std::size_t{128} << 10;  // a header holds more, but every part has one
    Json groups = Json::array();
    std::size_t size = 0;
    for (std::uint32_t i = 0; i < job.light_groups.size(); ++i) {
        Json group = {{"name", job.light_groups[i]}};
        const color::Spectrum* spectrum = common_spectrum(job.scene.description, i);
        if (spectrum != nullptr && (size += spectrum->values().size() * 20) <= kRoom) {
            const auto rounded = [](std::span<const double> numbers) {  // to what a table of floats keeps
                Json list = Json::array();
                for (const double x : numbers) list.push_back(std::stod(fmt::format("{:.8g}", x)));
                return list;
            };
            group["spectrum"] = {{"nm", rounded(spectrum->lambda_nm())},
                                 {"value", rounded(spectrum->values())},
                                 {"goes_on", spectrum->outside() == color::Outside::kClamped}};
        }
        groups.push_back(std::move(group));
    }
    return groups;
}

// Names of materials by number, as far as there is room, and if any has one.
Json json_of_materials(const RenderJob& job) {
    constexpr std::size_t kRoom = std::size_t{64} << 10;
    Json names = Json::array();
    std::size_t size = 0;
    bool any = false;
    for (const MaterialDescription& material : job.scene.description.materials) {
        if ((size += material.name.size() + 4) > kRoom) break;
        names.push_back(material.name);
        any = any || !material.name.empty();
    }
    return any ? names : Json();
}

}  // namespace

std::string provenance(const RenderJob& job, const RenderSettings& settings, std::uint64_t committed_before) {
    const IntegratorSettings& integrator = job.settings;
    const bool bdpt = integrator.kind == IntegratorKind::kBdpt;
    char host[256] = "";
    ::gethostname(host, sizeof host - 1);
    Json out = {
        {"program", "latent-render " LATENT_VERSION}, {"scene", settings.scene.string()}, {"integrator", bdpt ? "bdpt" : "path"}};
    for (const std::filesystem::path& addition : settings.additions) out["additions"].push_back(addition.string());
    if (bdpt) out["connections"] = integrator.connections == Connections::kAll ? "all" : "one";
    if (integrator.max_depth == kUnlimited) {
        out["max_depth"] = "unlimited";
    } else {
        out["max_depth"] = integrator.max_depth;
    }
    out["record"] = integrator.record == sampledb::RecordKind::kXyz ? "xyz" : "spectral";
    out["wavelengths"] = integrator.batch;
    if (settings.rgb_spectra == color::RgbSpectra::kBasis) out["rgb_spectra"] = "basis";
    out["sampler"] = settings.sampler == sampledb::PositionSampler::kPixels ? "pixels" : "halton";
    out["seed"] = integrator.seed;
    if (settings.samples || !settings.more_than.empty()) out["samples"] = {job.all.first, job.all.end};
    if (!settings.samples) out["spp"] = settings.spp;
    out["resolution"] = {job.resolution.width, job.resolution.height};
    if (settings.shard.count > 1) out["shard"] = fmt::format("{}/{}", settings.shard.index, settings.shard.count);
    out["simd"] = job.settings.simd;
    out["embree"] = Geometry::embree_version();
    out["render_epoch"] = kRenderEpoch;
    if (settings.aovs.any()) out["aovs"] = to_text(settings.aovs);
    const CameraDescription& camera = job.scene.description.camera;
    if (camera.kind == CameraKind::kPerspective && camera.lens_radius > 0) {
        out["lens"] = {{"radius", camera.lens_radius},
                       {"focus", camera.focal_distance},
                       {"window", {camera.x0, camera.y0, camera.x1, camera.y1}}};
    }
    if (settings.aovs.id) {
        Json names = json_of_materials(job);
        if (!names.is_null()) out["materials"] = std::move(names);
    }
    if (!job.light_groups.empty()) out["light_groups"] = json_of_groups(job);
    if (committed_before > 0) out["committed_before"] = committed_before;
    out["host"] = host;
    out["date"] = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
    return json_text(out, -1);
}

}  // namespace latent::render
