#include "render/program/forecast.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/file.h"
#include "base/size.h"
#include "base/temporary_path.h"

namespace latent::render {

namespace {

constexpr double kTrialSeconds = 1;  // before a render that may not fit

std::string full_name(const std::filesystem::path& folder) {
    std::error_code error;  // there may be no working folder any more
    const std::filesystem::path full = std::filesystem::absolute(folder / "", error);
    return error ? folder.string() : full.lexically_normal().parent_path().string();
}

std::uint64_t scaled(std::uint64_t bytes, double factor) {
    return static_cast<std::uint64_t>(std::min(static_cast<double>(bytes) * factor, 0x1p63));
}

}  // namespace

bool has_pictures(const SceneDescription& scene) {
    return std::ranges::any_of(scene.textures, [](const TextureDescription& t) {
        return t.kind == TextureKind::kImage || t.kind == TextureKind::kNormalMap;
    });
}

double trial_seconds(const RenderOptions& options) {
    constexpr double kMax = 2;
    return options.max_seconds > 0 ? std::min(options.max_seconds, kMax) : kMax;
}

Error TrialPlace::explained(const Error& error) const {
    if (error.code != ErrorCode::kNoSpace) return error;
    return {error.code,
            fmt::format("{}: no space left for the samples of the {}; free some, or {}", full_name(parent), purpose, remedy)};
}

Result<Trial> render_trial(const RenderJob& job, const RenderOptions& options, double seconds, const TrialPlace& place,
                           const std::atomic<bool>& stop) {
    Trial out{.folder = TemporaryPath(place.parent / (".latent-trial-" + make_nonce())), .file = {}};
    const std::filesystem::path& folder = out.folder.path();
    std::error_code error;
    if (!std::filesystem::create_directory(folder, error)) {
        const Error refused = error_from_errno(error.value(), full_name(place.parent), "cannot write");
        if (refused.code == ErrorCode::kNoSpace) return place.explained(refused);
        return Error{refused.code, fmt::format("{}; {}", refused.message, place.remedy)};
    }
    RenderOptions trial = options;
    trial.output = folder / "trial.latent";
    trial.max_seconds = seconds;
    trial.min_samples = place.min_samples;
    trial.log = {};  // nothing of it stays
    Result<RenderReport> report = render(job, trial, stop, {});
    if (!report) return place.explained(report.error());
    // Finished samples of a run whose other grains were given up may not be committed: only what is counts.
    if (report->committed == 0)
        return Error{ErrorCode::kStopped,
                     fmt::format("the {} ended before any sample was finished{}", place.purpose, stop ? "" : place.if_too_short)};
    out.samples = report->committed;
    out.bytes = report->written.bytes_written;
    out.seconds_per_sample = report->seconds_per_sample;
    const std::filesystem::directory_iterator part(folder, error);  // the part, or an attempt at it
    if (error || part == std::filesystem::directory_iterator())
        return Error{ErrorCode::kIo,
                     fmt::format("{}: the samples of the {} are gone; {}", folder.string(), place.purpose, place.remedy)};
    out.file = part->path();
    return out;
}

namespace {

// What can be said before a trial, and which samples are missing.
Result<sampledb::Coverage> begin_forecast(const RenderJob& job, const RenderOptions& options, Forecast& out) {
    Result<sampledb::Coverage> missing = sampledb::PartWriter::find_missing(part_options(job, options), job.job);
    if (!missing) return missing;
    out.samples = job.range.size();
    out.committed = job.range.size() - missing->size();
    out.free_bytes = free_space(options.output, options.force);
    return missing;
}

}  // namespace

Result<Forecast> forecast(const RenderJob& job, const RenderOptions& options, const Trial& trial) {
    Forecast out;
    const Result<sampledb::Coverage> missing = begin_forecast(job, options, out);
    if (!missing) return missing.error();
    out.measured_samples = trial.samples;
    out.seconds = trial.seconds_per_sample * static_cast<double>(missing->size());
    out.bytes = scaled(trial.bytes, static_cast<double>(out.samples) / static_cast<double>(trial.samples));
    return out;
}

Result<Forecast> forecast(const RenderJob& job, const RenderOptions& options, double seconds, int max_trials,
                          const std::atomic<bool>& stop) {
    Forecast out;
    const Result<sampledb::Coverage> missing = begin_forecast(job, options, out);
    if (!missing) return missing.error();
    if (missing->empty()) return out;
    std::error_code error;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
    if (error) return Error{ErrorCode::kIo, "no folder for temporary files; set TMPDIR: " + error.message()};
    const TrialPlace place{parent, "dry run", "set TMPDIR to another folder",
                           options.max_seconds == seconds ? "; raise --max-time" : ""};
    Result<Trial> trial = render_trial(job, options, seconds, place, stop);
    const int most = has_pictures(job.scene.description) ? max_trials : 1;
    for (int i = 1; i < most && trial && !stop; ++i) {
        Result<Trial> again = render_trial(job, options, seconds, place, stop);
        if (!again) break;
        const bool is_warm = again->seconds_per_sample > 0.7 * trial->seconds_per_sample;
        trial = std::move(again);
        if (is_warm) break;
    }
    return trial ? forecast(job, options, *trial) : trial.error();
}

Status check_folder(const std::filesystem::path& output) {
    const std::filesystem::path folder = folder_of(output);
    std::error_code error;
    if (std::filesystem::is_directory(folder, error)) return {};
    const char* const problem = std::filesystem::exists(folder, error) ? "is not a folder" : "does not exist";
    return Error{ErrorCode::kIo, fmt::format("{}: {} {}", output.string(), folder.string(), problem)};
}

Status check_writable(const std::filesystem::path& output) {
    const Result<File> file = File::create_unnamed(full_name(folder_of(output)));
    if (file || file.error().code == ErrorCode::kNoSpace) return {};  // how much space there is, the forecast says
    return Error{file.error().code, file.error().message + "; choose another folder with -o"};
}

std::string too_large(const Forecast& forecast, const std::filesystem::path& output) {
    return fmt::format(
        "{}: needs about {}, but only {} are free in {}; free some space, or render less (--spp, --samples, --shard)",
        output.string(), format_size(forecast.bytes), format_size(forecast.free_bytes.value_or(0)), folder_of(output).string());
}

Status check_space(const RenderJob& job, const RenderOptions& options, const std::atomic<bool>& stop) {
    const std::optional<std::uint64_t> free = free_space(options.output, options.force);
    if (!free || job.range.size() <= *free / std::max<std::uint64_t>(job.raw_sample_bytes, 1)) return {};
    const Result<Forecast> expected = forecast(job, options, kTrialSeconds, 1, stop);
    if (!expected || expected->fits()) return {};  // what else is wrong, rendering says
    const double part_of_time = options.max_seconds > 0 ? options.max_seconds / expected->seconds : 1;
    if (part_of_time < 1 && scaled(expected->missing_bytes(), part_of_time) <= *free) return {};
    return Error{ErrorCode::kNoSpace, too_large(*expected, options.output) + "; to start anyway, use --ignore-space"};
}

}  // namespace latent::render
