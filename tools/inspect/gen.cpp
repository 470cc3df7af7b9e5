#include "tools/inspect/gen.h"

#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "base/first_error.h"
#include "base/parallel.h"
#include "base/size.h"
#include "sampledb/write/grain_queue.h"

namespace latent::inspect {

using namespace sampledb;

namespace {
constexpr std::chrono::duration<double> kProgressInterval(0.2);
}

Result<GenReport> generate(const GenOptions& options, const Progress& progress) {
    const auto begin = std::chrono::steady_clock::now();
    const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
    const std::uint64_t every = options.scene.every;
    if (options.records > (~std::uint64_t{0} - options.first) / every)
        return usage_error("--records: exceeds the last sample number");
    const SampleRange samples{options.first, options.first + options.records * every};
    GenReport report;
    report.output = options.output;
    report.job = synthetic_job(options.scene);
    if (const Status valid = report.job.validate(); !valid) return usage_error(valid.error().message);
    PartOptions part;
    part.path = options.output;
    part.range = samples;
    part.checkpoint_seconds = options.checkpoint_seconds;
    part.provenance_json = R"({"program":"latent-inspect gen"})";
    part.force = options.force;
    const Result<std::unique_ptr<PartWriter>> writer = PartWriter::open(part, report.job);
    if (!writer) return writer.error();

    GrainQueue queue((*writer)->missing());
    FirstError error;
    const auto tell = [&] {
        if (!progress || samples.empty()) return;
        const WriterCounts counts = (*writer)->counts();
        progress(static_cast<double>(counts.samples_committed) / static_cast<double>(samples.size()),
                 format_size(counts.bytes_written));
    };
    tell();
    {
        Workers workers(Threads::count_of(options.threads), error, [&](int) {
            for (SampleRange range = queue.next(); !range.empty() && !error; range = queue.next())
                error.keep((*writer)->submit(synthetic_grain(options.scene, report.job, range)));
        });
        while (!workers.wait(kProgressInterval)) {
            if (error) (*writer)->give_up();  // nobody is to wait for a grain that will not come
            tell();
        }
    }
    if (error) return error.status().error();
    if (Status s = (*writer)->finish(); !s) return s.error();
    report.counts = (*writer)->counts();
    report.seconds = seconds();
    return report;
}

std::string to_text(const GenReport& report) {
    return fmt::format("{}: {} samples, {} in {}\n", report.output.string(), report.counts.samples_committed,
                       format_size(report.counts.bytes_written), format_duration(report.seconds));
}

nlohmann::json to_json(const GenReport& report) {
    return {{"output", report.output.string()},
            {"job", to_hex(report.job.id)},
            {"samples", report.counts.samples_committed},
            {"bytes", report.counts.bytes_written},
            {"runs", report.counts.runs_written},
            {"checkpoints", report.counts.checkpoints_written},
            {"seconds", report.seconds}};
}

}  // namespace latent::inspect
