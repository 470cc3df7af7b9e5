// tools/merge/compact.h: many small runs become one large one, record by record along the Z-order curve, in bounded memory.
#pragma once

#include <cstdint>
#include <functional>

#include "base/file.h"
#include "base/result.h"
#include "sampledb/read/run_set.h"
#include "tools/merge/compact_groups.h"

namespace latent::merge {

// Writes the run at `offset`; its coverage lists what the group's runs covered. `report` hears how many bytes it has so far. Runs
// on the threads of the arena that it is called in; their number changes no byte, nor does `memory`, of which about as much is
// used. Errors: kCorrupt, kIo, kNoSpace.
Result<sampledb::RunHeader> compact_runs(const sampledb::RunSet& run_set, const CompactGroup& group, std::uint64_t memory,
                                         File& out, std::uint64_t offset, const std::function<void(std::uint64_t)>& report);

}  // namespace latent::merge
