// tools/merge/compact_groups.h: which runs are compacted together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sampledb/data/job.h"
#include "sampledb/read/run_set.h"

namespace latent::merge {

// Consecutive runs of a run set that make one new run.
struct CompactGroup {
    std::size_t first, end;
};

// Bytes that a decoded page of a job takes at most while it is compacted.
std::uint64_t page_memory(const sampledb::Job& job);

// Groups as large as `memory` allows; each covers whole intervals of S samples, so that the new run supersedes every run that could
// ever be in its place. Runs of intervals that are not complete are in no group, neither are those that would stay alone.
std::vector<CompactGroup> compact_groups(const sampledb::RunSet& run_set, std::uint64_t memory);

}  // namespace latent::merge
