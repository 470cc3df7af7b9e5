// tools/merge/compact.h: many small runs become one large one, record by record along the Z-order curve, in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/file.h"
#include "base/result.h"
#include "sampledb/read/gathering.h"

namespace latent::merge {

// Consecutive runs of a gathering that make one new run.
struct CompactGroup {
    std::size_t first, end;
};

// Bytes that a decoded page of a job takes at most while it is compacted.
std::uint64_t page_memory(const sampledb::Job& job);

// Groups as large as `memory` allows; each covers whole intervals of S samples, so that the new run supersedes every run that could
// ever be in its place. Runs of intervals that are not complete are in no group, neither are those that would stay alone.
std::vector<CompactGroup> compact_groups(const sampledb::Gathering& gathering, std::uint64_t memory);

// Writes the run at `offset`; its coverage lists what the group's runs covered. `report` hears how many bytes it has so far. Runs
// on the threads of the arena that it is called in; their number changes no byte, nor does `memory`, of which about as much is
// used. Errors: kCorrupt, kIo, kNoSpace.
Result<sampledb::RunHeader> compact_runs(const sampledb::Gathering& gathering, const CompactGroup& group, std::uint64_t memory,
                                         File& out, std::uint64_t offset, const std::function<void(std::uint64_t)>& report);

}  // namespace latent::merge
