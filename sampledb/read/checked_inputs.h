// sampledb/read/checked_inputs.h: the first half of opening a run set: the files that a tool was given are read and checked against
// each other. docs/format.md, "Selection".
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/result.h"
#include "sampledb/read/recent_cache.h"
#include "sampledb/read/run_set.h"
#include "sampledb/read/selection.h"

namespace latent::sampledb {

struct CheckedInputs {
    Job job;
    std::vector<std::filesystem::path> files;  // those of the job
    std::vector<SelectedRun> runs;             // to choose from, in no particular order
    std::optional<Resolution> resolution;      // RunSet::resolution
    std::uint64_t list_memory = 0;             // bytes that the runs take, those that choosing takes included
    RunSetReport report;                       // what was left out so far
};

// `sources`: the files stay open there, as many as it holds, by their index in `files`. Errors: those of RunSet::open.
Result<CheckedInputs> checked_inputs(const RunSetOptions& options, RecentCache<ByteSource>& sources);

}  // namespace latent::sampledb
