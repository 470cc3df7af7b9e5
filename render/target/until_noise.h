// render/target/until_noise.h: renders until a picture is as clean as was asked for. docs/jobs.md, "Until it is clean".
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "base/progress.h"
#include "base/result.h"
#include "render/program/loop.h"
#include "tools/develop/noise/noise.h"

namespace latent::render {

struct UntilNoiseReport {
    RenderReport render;                       // adds up all rounds; not complete: the last was stopped
    std::optional<develop::NoiseLevel> noise;  // noise of all that was rendered, unless it was stopped
    double measuring_seconds = 0;              // RenderReport::seconds does not contain them
    std::string shortfall;                     // why the target was not reached; empty if it was, or if it was stopped
};

// Renders samples from the first of `job.range` on, in rounds: each ends with a finished file of the samples so far, whose noise
// says how long the next one is. The last sample of the range is the last that is rendered; `job.range` becomes what the file
// holds. options.max_seconds counts for all rounds together; the provenance is made anew for each. Errors: of `render` and of
// measuring.
Result<UntilNoiseReport> render_until(RenderJob& job, RenderSettings settings, RenderOptions options, const NoiseTarget& target,
                                      bool ignore_space, const std::atomic<bool>& stop, const Progress& progress);

std::string to_text(const UntilNoiseReport& report, const NoiseTarget& target, const RenderJob& job, bool json);

}  // namespace latent::render
