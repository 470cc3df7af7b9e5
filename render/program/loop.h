// render/program/loop.h: the loop of latent-render: threads trace grains of samples into one part, which can be stopped at any
// moment.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "base/progress.h"
#include "base/result.h"
#include "render/program/job.h"
#include "render/transport/integrator.h"
#include "sampledb/write/part_writer.h"

namespace latent::render {

struct RenderOptions {
    std::filesystem::path output;
    double checkpoint_seconds = 60;
    double max_seconds = 0;         // 0: no limit
    std::uint64_t min_samples = 0;  // the limit counts only once so many are done
    int threads = 1;
    bool force = false;
    std::string provenance_json;
    std::function<void(const std::string&)> log;  // may be empty; called with a line for each commit (commit_log.h)
};

struct RenderReport {
    bool complete = false;        // else stopped: what was rendered is committed
    bool elsewhere = false;       // complete because another process published the whole range meanwhile
    std::uint64_t samples = 0;    // rendered now
    std::uint64_t committed = 0;  // in the range, earlier work included
    double seconds = 0;
    double seconds_per_sample = 0;  // once warm: in the second half of options.max_seconds
    std::uint64_t shadow_rays = 0;
    RadianceFaults faults;
    sampledb::WriterCounts written;
};

// The part that these options name.
sampledb::PartOptions part_options(const RenderJob& job, const RenderOptions& options);

// Renders what is missing of the job's range into `options.output`. `stop` may become true at any moment, from a signal handler.
// Errors: those of sampledb::PartWriter.
Result<RenderReport> render(const RenderJob& job, const RenderOptions& options, const std::atomic<bool>& stop,
                            const Progress& progress);

}  // namespace latent::render
