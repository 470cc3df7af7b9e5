#include "render/program/loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <mutex>

#include "base/parallel.h"
#include "base/size.h"
#include "base/stopwatch.h"
#include "render/program/commit_log.h"
#include "sampledb/write/grain_queue.h"

namespace latent::render {

namespace {

using Clock = std::chrono::steady_clock;
using sampledb::Grain;
using sampledb::SampleRange;

constexpr double kGraceSeconds = 4;  // after a stop: grains that are nearly done may end, slower ones are given up
constexpr std::chrono::duration<double> kProgressInterval(0.2);
constexpr double kLogInterval = 10;  // seconds; a checkpoint interval may be shorter

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

// Grains of what is missing, in order of sample number; the state that the threads share.
class Work {
 public:
    Work(const sampledb::Coverage& missing, const std::atomic<bool>& stop, const RenderOptions& options)
        : grains_(missing), stop_(stop), max_seconds_(options.max_seconds), min_samples_(options.min_samples) {}

    // The next grain; empty when there is none, or no more is wanted.
    SampleRange next() { return stopping() ? SampleRange{} : grains_.next(); }
    bool stopping() {
        const bool is_over = max_seconds_ > 0 && seconds_since(begin_) > max_seconds_;
        return stop_ || error_ || (is_over && (min_samples_ == 0 || samples() >= min_samples_));
    }
    // True once a grain in work is no longer worth waiting for.
    bool give_up() {
        if (error_) return true;
        if (!stopping()) return false;
        double stopped = stopped_at_.load();
        if (stopped < 0 && stopped_at_.compare_exchange_strong(stopped, seconds_since(begin_))) return false;
        return seconds_since(begin_) > stopped_at_.load() + kGraceSeconds;
    }
    void finished(const SampleRange& grain, const RadianceFaults& faults) {
        const std::lock_guard lock(mutex_);
        samples_ += grain.size();
        faults_ += faults;
        if (warm_seconds_ == 0 && max_seconds_ > 0 && seconds() > 0.5 * max_seconds_) {
            warm_seconds_ = seconds();
            warm_samples_ = samples_;
        }
    }
    double seconds() const { return seconds_since(begin_); }
    FirstError& error() { return error_; }
    std::uint64_t samples() const {
        const std::lock_guard lock(mutex_);
        return samples_;
    }
    const RadianceFaults& faults() const { return faults_; }
    // Once all threads are done, at `end` seconds: of each sample. Of a limited time, the second half counts: textures are read
    // when they are needed first.
    double seconds_per_sample(double end) const {
        const bool is_warm = warm_seconds_ > 0 && samples_ > warm_samples_;
        return is_warm ? (end - warm_seconds_) / static_cast<double>(samples_ - warm_samples_)
                       : end / static_cast<double>(samples_);
    }

 private:
    sampledb::GrainQueue grains_;
    const std::atomic<bool>& stop_;
    const double max_seconds_;
    const std::uint64_t min_samples_;
    const Clock::time_point begin_ = Clock::now();
    std::atomic<double> stopped_at_{-1};
    FirstError error_;

    mutable std::mutex mutex_;
    std::uint64_t samples_ = 0, warm_samples_ = 0;
    double warm_seconds_ = 0;
    RadianceFaults faults_;
};

void trace_grains(const Integrator& integrator, sampledb::PartWriter& writer, Work& work) {
    for (SampleRange range = work.next(); !range.empty() && !writer.published_elsewhere(); range = work.next()) {
        Grain grain{.range = range, .records = {}};
        RadianceFaults faults;
        for (std::uint64_t n = range.first; n < range.end; ++n) {
            if (work.give_up()) return writer.give_up();
            integrator.trace(n, grain.records, faults);
        }
        if (const Status sound = integrator.status(); !sound) return work.error().set(sound.error());
        const Status submitted = writer.submit(std::move(grain));
        if (!submitted && submitted.error().code == ErrorCode::kStopped) return;
        if (!submitted) return work.error().set(submitted.error());
        work.finished(range, faults);
    }
}

// `before`: samples of the range that earlier work has committed. The pace is that of this run.
void tell(const Progress& progress, const Work& work, const SampleRange& range, std::uint64_t before,
          const sampledb::PartWriter& writer) {
    const std::uint64_t samples = work.samples();
    progress(static_cast<double>(before + samples) / static_cast<double>(range.size()),
             fmt::format("{} samples/s, {} written", format_count(static_cast<double>(samples) / work.seconds()),
                         format_size(writer.counts().bytes_written)));
}

// Says what is committed by now, if that is news.
void tell(const RenderOptions& options, CommitLog& log, const Work& work, const sampledb::PartWriter& writer, bool final) {
    if (!options.log) return;
    const sampledb::WriterCounts counts = writer.counts();
    const double rate = static_cast<double>(work.samples()) / work.seconds();
    const std::string line = log.line({counts.samples_committed, counts.bytes_written, rate}, Clock::now(), final);
    if (!line.empty()) options.log(line);
}

}  // namespace

sampledb::PartOptions part_options(const RenderJob& job, const RenderOptions& options) {
    return {.path = options.output,
            .range = job.range,
            .checkpoint_seconds = options.checkpoint_seconds,
            .provenance_json = options.provenance_json,
            .force = options.force};
}

Result<RenderReport> render(const RenderJob& job, const RenderOptions& options, const std::atomic<bool>& stop,
                            const Progress& progress) {
    Result<std::unique_ptr<sampledb::PartWriter>> opened = sampledb::PartWriter::open(part_options(job, options), job.job);
    if (!opened) return opened.error();
    sampledb::PartWriter& writer = **opened;

    Work work(writer.missing(), stop, options);
    const std::uint64_t total = writer.missing().size(), before = job.range.size() - total;
    if (progress && total > 0) progress(static_cast<double>(before) / static_cast<double>(job.range.size()), "");
    const std::uint64_t shadow_rays_before = job.integrator->shadow_rays();  // those of forecasts
    CommitLog log(job.range.size(), std::min(options.checkpoint_seconds, kLogInterval));
    tell(options, log, work, writer, false);
    {
        Workers workers(options.threads, work.error(), [&](int) { trace_grains(*job.integrator, writer, work); });
        while (!workers.wait(kProgressInterval)) {
            if (work.error()) writer.give_up();  // no one is to wait for a grain that will not come
            if (progress) tell(progress, work, job.range, before, writer);
            tell(options, log, work, writer, false);
        }
    }
    if (work.error()) return work.error().status().error();
    const double traced = work.seconds();

    RenderReport report;
    report.elsewhere = total > 0 && writer.published_elsewhere();
    report.complete = report.elsewhere || work.samples() == total;
    const Status closed =
        report.complete ? writer.finish(fmt::format(R"({{"cpu_seconds":{:.1f}}})", cpu_seconds())) : writer.checkpoint();
    if (!closed) return closed.error();
    tell(options, log, work, writer, true);
    report.samples = work.samples();
    report.seconds = work.seconds();
    report.seconds_per_sample = report.samples > 0 ? work.seconds_per_sample(traced) : 0;
    report.shadow_rays = job.integrator->shadow_rays() - shadow_rays_before;
    report.faults = work.faults();
    report.written = writer.counts();
    report.committed = report.written.samples_committed;
    return report;
}

}  // namespace latent::render
