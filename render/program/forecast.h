// render/program/forecast.h: the time and disk space that a job will take, before it is rendered.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "base/temporary_path.h"
#include "render/program/loop.h"

namespace latent::render {

struct Forecast {
    std::uint64_t samples = 0;    // in the job's range
    std::uint64_t committed = 0;  // those of them that earlier work has committed
    double seconds = 0;           // for the others
    std::uint64_t bytes = 0;      // size of the whole part: a resumed render copies what was committed before it removes that
    std::uint64_t measured_samples = 0;
    std::optional<std::uint64_t> free_bytes;  // in the folder of the output, if the system says

    std::uint64_t missing_bytes() const {
        return static_cast<std::uint64_t>(static_cast<double>(bytes) * static_cast<double>(samples - committed) /
                                          static_cast<double>(samples));
    }
    bool fits() const { return !free_bytes || committed == samples || bytes <= *free_bytes; }
};

// Which are read when they are first seen: the beginning of a render says little about the rest.
bool has_pictures(const SceneDescription& scene);

// How long a dry run renders: two seconds, or less if --max-time says so.
double trial_seconds(const RenderOptions& options);

// A short render, in a folder of its own that is gone with it.
struct Trial {
    TemporaryPath folder;
    std::filesystem::path file;     // what it committed
    std::uint64_t samples = 0;      // in it, at least one
    std::uint64_t bytes = 0;        // its size
    double seconds_per_sample = 0;  // RenderReport's
};
// Where a trial makes its folder, what it is for ("preview"), what to do if that cannot be: "choose another folder with -o", and
// what if no sample was finished: "; give it more time". Its time is over only once so many samples are done.
struct TrialPlace {
    std::filesystem::path parent;
    std::string_view purpose;
    std::string_view remedy;
    std::string_view if_too_short;
    std::uint64_t min_samples = 0;

    // Replaces the error of a full disk, which names a hidden folder, by one that says what to do.
    Error explained(const Error& error) const;
};
// Renders for `seconds`. Errors: those of `render`, and kStopped if no sample was committed.
Result<Trial> render_trial(const RenderJob& job, const RenderOptions& options, double seconds, const TrialPlace& place,
                           const std::atomic<bool>& stop);

Result<Forecast> forecast(const RenderJob& job, const RenderOptions& options, const Trial& trial);
// From a trial of `seconds` in the system's folder for temporary files, unless nothing is missing. Pictures are read when they are
// needed first, which may take longer than a trial: in a scene with pictures, the trial is repeated, up to `max_trials` in all,
// until one is less than 30 % faster than the one before.
inline constexpr int kMaxTrials = 4;
Result<Forecast> forecast(const RenderJob& job, const RenderOptions& options, double seconds, int max_trials,
                          const std::atomic<bool>& stop);

// Before the scene is read. Errors: kIo if there is no folder for the output.
Status check_folder(const std::filesystem::path& output);

// Before a forecast for a file that is to be written. Errors: kIo if no file can be made in its folder. A full disk is no error
// here: the forecast reports the space.
Status check_writable(const std::filesystem::path& output);

// For a forecast that does not fit: what, where, and what to do.
std::string too_large(const Forecast& forecast, const std::filesystem::path& output);

// Before rendering. Takes no time where uncompressed records would fit, else a second. Errors: kNoSpace if the part, or what
// --max-time lets it become, will not fit. No answer is none.
Status check_space(const RenderJob& job, const RenderOptions& options, const std::atomic<bool>& stop);

}  // namespace latent::render
