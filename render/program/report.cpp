#include "render/program/report.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <ctime>

#include "base/hash.h"
#include "base/json.h"
#include "base/size.h"

namespace latent::render {

namespace {
using Json = nlohmann::ordered_json;
}

std::string to_text(const RadianceFaults& faults) {
    return fmt::format("{} records were stored as black: {} NaN, {} infinite, {} negative", faults.total(), faults.nan,
                       faults.infinite, faults.negative);
}

std::string to_text(const RenderReport& report, const RenderJob& job, bool json) {
    const double rate = report.seconds > 0 ? static_cast<double>(report.samples) / report.seconds : 0;
    if (json) {
        const Json out = {{"job", to_hex(job.job.id)},
                          {"first_sample", job.range.first},
                          {"end_sample", job.range.end},
                          {"complete", report.complete},
                          {"finished_elsewhere", report.elsewhere},
                          {"samples_rendered", report.samples},
                          {"samples_committed", report.committed},
                          {"seconds", report.seconds},
                          {"samples_per_second", rate},
                          {"bytes_written", report.written.bytes_written},
                          {"runs_written", report.written.runs_written},
                          {"checkpoints_written", report.written.checkpoints_written},
                          {"nan", report.faults.nan},
                          {"infinite", report.faults.infinite},
                          {"negative", report.faults.negative}};
        return json_text(out) + "\n";
    }
    const bool was_complete = report.complete && report.samples == 0 && !report.elsewhere;
    const std::string rendered = was_complete ? "nothing was left to render"
                                              : fmt::format("{} rendered in {} ({:.3f} M samples/s)", report.samples,
                                                            format_duration(report.seconds), rate / 1e6);
    return fmt::format("job {}\nsamples {}:{}, {}, {} written\n{}", to_hex(job.job.id), job.range.first, job.range.end, rendered,
                       format_size(report.written.bytes_written),
                       report.elsewhere ? "another process has finished this part meanwhile: nothing was left to do\n" : "");
}

std::string to_text(const RenderEstimate& estimate, bool json) {
    if (json) {
        const Json out = {{"samples", estimate.samples},
                          {"bytes", estimate.bytes},
                          {"seconds", estimate.seconds},
                          {"measured_samples", estimate.measured_samples}};
        return json_text(out) + "\n";
    }
    return fmt::format("{} samples would take {} and {} on disk (measured on {} samples)\n", estimate.samples,
                       format_duration(estimate.seconds), format_size(estimate.bytes), estimate.measured_samples);
}

std::string provenance(const RenderJob& job, const RenderSettings& settings) {
    char host[256] = "";
    ::gethostname(host, sizeof host - 1);
    const Json out = {{"program", "latent-render " LATENT_VERSION},
                      {"scene", settings.scene.string()},
                      {"simd", job.simd},
                      {"render_epoch", kRenderEpoch},
                      {"seed", settings.seed},
                      {"host", host},
                      {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))}};
    return json_text(out, -1);
}

}  // namespace latent::render
