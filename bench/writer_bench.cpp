// bench/writer_bench.cpp: records per second and core through PartWriter, from submit to a published file.
//   writer_bench [MILLION [PRECISION]]
// Grains are made beforehand. Prints CPU seconds of the process (all threads) and wall seconds for each of five repeats, and checks
// that the published file holds every record.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "base/file.h"
#include "base/stopwatch.h"
#include "sampledb/read/run_set.h"
#include "sampledb/write/part_writer.h"
#include "sampledb/write/run_assembler.h"
#include "tests/support/synthetic.h"

namespace {

using namespace latent;
using namespace latent::sampledb;

double cpu_seconds() {
    struct rusage usage;
    ::getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

bool bench(RecordKind kind, std::uint64_t samples, std::uint8_t precision, const std::filesystem::path& name) {
    Job job = synthetic::make_job(kind);
    job.precision = precision;
    job.run_samples = kind == RecordKind::kXyz ? 1u << 20 : 1u << 18;
    std::vector<Grain> grains;
    std::uint64_t records = 0;
    for (std::uint64_t first = 0; first < samples; first = grains.back().range.end) {
        const SampleRange range = grain_range(first, {0, samples});
        grains.push_back({range, synthetic::make_records(job, range)});
        records += grains.back().records.size();
    }
    std::vector<double> rates;
    for (int repeat = 0; repeat < 5; ++repeat) {
        std::filesystem::remove(name);
        std::vector<Grain> given = grains;
        const double cpu = cpu_seconds();
        const Stopwatch wall;
        const auto writer = PartWriter::open({name, {0, samples}, 60, "", false}, job);
        if (!writer) return false;
        for (Grain& grain : given) {
            if (!(*writer)->submit(std::move(grain))) return false;
        }
        if (!(*writer)->finish()) return false;
        const double seconds = cpu_seconds() - cpu;
        rates.push_back(static_cast<double>(records) / seconds * 1e-6);
        fmt::print("{:<9} {:>5.1f} M records: CPU {:.3f} s, wall {:.3f} s, {:.1f} M records/s and core, {:.2f} bytes a record\n",
                   kind == RecordKind::kXyz ? "XYZ" : "28 pairs", static_cast<double>(records) * 1e-6, seconds, wall.seconds(),
                   rates.back(), static_cast<double>(std::filesystem::file_size(name)) / static_cast<double>(records));
    }
    RunSetOptions options;
    options.inputs = {name};
    const auto run_set = RunSet::open(options);
    std::uint64_t stored = 0;
    if (run_set) {
        for (const SelectedRun& run : (*run_set)->runs()) stored += run.header.camera_records + run.header.light_records;
    }
    std::sort(rates.begin(), rates.end());
    fmt::print("{:<9} median {:.1f} M records/s and core (range {:.1f} .. {:.1f})\n", "", rates[2], rates.front(), rates.back());
    return stored == records;
}

}  // namespace

int main(int argc, char** argv) {
    const std::uint64_t samples = (argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 4) * 1000000;
    const auto precision = static_cast<std::uint8_t>(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 9);
    const std::filesystem::path name = std::filesystem::temp_directory_path() / ("writer-bench-" + make_nonce() + ".latent");
    const bool done =
        bench(RecordKind::kXyz, samples, precision, name) && bench(RecordKind::kSpectral, samples / 8, precision, name);
    std::filesystem::remove(name);
    return done ? 0 : 1;
}
