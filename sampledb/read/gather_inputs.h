// sampledb/read/gather_inputs.h: the first half of gathering: the files that a tool was given are read and checked against each
// other. docs/format.md, "Selection".
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/result.h"
#include "sampledb/read/gathering.h"
#include "sampledb/read/recent_cache.h"
#include "sampledb/read/selection.h"

namespace latent::sampledb {

struct GatheredInputs {
    Job job;
    std::vector<std::filesystem::path> files;  // those of the job
    std::vector<SelectedRun> runs;             // to choose from, in no particular order
    std::optional<Resolution> resolution;      // Gathering::resolution
    std::uint64_t list_memory = 0;             // bytes that the runs take, those that choosing takes included
    GatherReport report;                       // what was left out so far
};

// `sources`: the files stay open there, as many as it holds, by their index in `files`. Errors: those of Gathering::open.
Result<GatheredInputs> gather_inputs(const GatherOptions& options, RecentCache<ByteSource>& sources);

}  // namespace latent::sampledb
