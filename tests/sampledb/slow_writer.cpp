// tests/sampledb/slow_writer.cpp: renders a synthetic part slowly, through PartWriter, for tests that kill it or let its disk fail.
// Usage: slow_writer NAME SAMPLES RUN_SAMPLES CHECKPOINT_SECONDS MICROSECONDS_PER_GRAIN JOB [spectral]
// Prints "committed N" whenever more samples are on disk, and at the end "uncommitted N", the most that were submitted and not on
// disk; exit status 0 when NAME is published, else 1 and the reason.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "sampledb/write/grain_queue.h"
#include "sampledb/write/part_writer.h"
#include "tests/support/synthetic.h"

namespace {

using namespace latent;
using namespace latent::sampledb;

int fail(const Error& error) {
    fmt::print(stderr, "slow_writer: {}\n", error.message);
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 7) return 2;
    Job job = synthetic::make_job(argc > 7 ? RecordKind::kSpectral : RecordKind::kXyz, std::stoull(argv[6]));
    job.run_samples = static_cast<std::uint32_t>(std::stoul(argv[3]));
    const SampleRange range{0, std::stoull(argv[2])};
    const Result<std::unique_ptr<PartWriter>> writer = PartWriter::open({argv[1], range, std::stod(argv[4]), "{}", false}, job);
    if (!writer) return fail(writer.error());

    std::atomic<bool> over = false;
    std::thread reporter([&] {
        for (std::uint64_t told = 0;; std::this_thread::sleep_for(std::chrono::microseconds(200))) {
            const bool last = over;  // asked first, so that nothing is left untold
            if (const std::uint64_t committed = (*writer)->counts().samples_committed; committed != told) {
                fmt::print("committed {}\n", told = committed);
                std::fflush(stdout);
            }
            if (last) return;
        }
    });
    Status status;
    std::uint64_t submitted = (*writer)->counts().samples_committed, uncommitted = 0;
    GrainQueue grains((*writer)->missing());
    for (SampleRange grain = grains.next(); status && !grain.empty(); grain = grains.next()) {
        std::this_thread::sleep_for(std::chrono::microseconds(std::stoul(argv[5])));
        status = (*writer)->submit({grain, synthetic::make_records(job, grain)});
        submitted += grain.size();
        uncommitted = std::max(uncommitted, submitted - (*writer)->counts().samples_committed);
    }
    if (status) status = (*writer)->finish();
    over = true;
    reporter.join();
    fmt::print("uncommitted {}\n", uncommitted);
    return status ? 0 : fail(status.error());
}
