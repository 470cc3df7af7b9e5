// tests/support/synthetic.h: jobs, records and whole files made up from sample numbers, for the tests and benches of all rooms.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/job.h"
#include "sampledb/data/record.h"
#include "sampledb/format/run_header.h"

namespace latent::synthetic {

// A valid job: Halton positions, one light path per sample, runs of 2^14 samples; spectral jobs have 28 wavelengths and a
// density like the eye's. `id` tells jobs apart. Change what a test needs.
sampledb::Job make_job(sampledb::RecordKind kind, std::uint64_t id = 1);

// Positions by pixels, instead of make_job's Halton.
sampledb::PositionSamplerSpec pixels_of(std::uint32_t width, std::uint32_t height);

// The same with short runs, so that small files have several.
inline constexpr std::uint64_t kShortRun = 4096;
sampledb::Job make_short_job(sampledb::RecordKind kind = sampledb::RecordKind::kXyz, std::uint64_t id = 1);

// One run for each pair of neighbouring boundaries.
std::vector<sampledb::Coverage> runs_between(std::initializer_list<std::uint64_t> boundaries);

// What the film sees. Records are a function of (job, scene, sample number) alone.
struct Scene {
    enum class Look { kUniform, kTextured };
    Look look = Look::kTextured;     // uniform: every record has the value 1; textured: a pattern times exponential noise
    double black = 0.1;              // share of camera records that are black
    double light_per_sample = 0.05;  // mean number of light records of a sample, at random positions
    bool split_shares = false;       // every fourth sample has two camera records of share 1/2
    std::uint64_t seed = 1;
};

// All records of the samples of `range`, ascending by sample. Positions follow the job's sampler; without one they are random.
// A record of value 1: XYZ = (1, 1, 1); spectral: the spectrum L = 1, P_i = 1 / (k p(lambda_i)). Extra columns hold noise.
sampledb::Records make_records(const sampledb::Job& job, sampledb::SampleRange range, const Scene& scene = {});

// A file in memory: one run for each coverage, in the order given; with a footer, or as an unfinished part.
struct FileBytes {
    Bytes bytes;
    std::vector<std::size_t> run_ends;  // the byte behind each run; the first begins at `header_size`
    std::size_t header_size = 0;        // both copies
};
FileBytes make_file(const sampledb::Job& job, std::span<const sampledb::Coverage> runs, bool footer = true, const Scene& scene = {},
                    const std::string& provenance_json = "");

// The runs of such a file, as its footer lists them.
std::vector<sampledb::RunInfo> runs_of(const FileBytes& file);
// A footer as version 0.1 wrote it, to be put at `offset`, the end of the last run.
Bytes make_first_footer(std::span<const sampledb::RunInfo> runs, std::uint64_t offset);

// The file with another transform of the first column of the first page of a run; every hash is right.
Bytes with_transform(const FileBytes& file, std::size_t run, std::uint8_t transform);

// Writes bytes to a file of that name, replacing what is there.
void write_file(const std::filesystem::path& path, ByteSpan bytes);

}  // namespace latent::synthetic
