// tools/merge/merge.h: the parts of one job become one file. Runs are copied as they are; --compact alone decodes records, and
// keeps every one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/read/run_set.h"

namespace latent::merge {

struct MergeOptions {
    std::vector<std::filesystem::path> inputs;  // files and folders
    std::filesystem::path output;
    bool replace = false;                          // --force
    bool skip_duplicates = false;                  // a part that was named twice counts once
    bool keep_going = false;                       // parts that cannot be used are left out, though they were named
    std::optional<sampledb::JobId> job;            // keep only this job
    std::optional<sampledb::SampleRange> require;  // fail unless all of these samples are there
    // How copies of runs are verified before they count; kQuick also checks all runs before they are chosen.
    sampledb::VerifyLevel verify = sampledb::VerifyLevel::kStored;
    bool compact = false;  // rewrite complete intervals as few large runs
    std::uint64_t memory = std::uint64_t{1} << 30;
    int threads = 0;                               // that compact, and decode for kFull; 0: as many as the machine has
    std::uint64_t piece = std::uint64_t{2} << 20;  // bytes that are copied and checked at once: what the cache of a processor holds
};

struct MergeReport {
    std::string output;
    bool compacted = false;
    sampledb::Job job;
    sampledb::Coverage coverage;
    std::uint64_t files = 0;  // that runs were taken from
    std::uint64_t runs_in = 0, runs_out = 0;
    std::uint64_t camera_records = 0, light_records = 0;
    std::uint64_t bytes = 0;  // the output's
    sampledb::RunSetReport run_set;
};

// Writes the output: header, runs ascending by first sample, footer. The same bytes whatever the order of the inputs.
// Errors: those of RunSet::open, kMismatch (`require` not met), kExists, kCorrupt (the copy differs from what was read), kIo,
// kNoSpace; then there is no output.
Result<MergeReport> merge(const MergeOptions& options, const Progress& progress = {});

}  // namespace latent::merge
