// sampledb/read/run_walk.h: the runs of a file, found one behind the other without its footer. docs/format.md, "Reading".
#pragma once

#include <cstdint>
#include <vector>

#include "base/result.h"
#include "sampledb/format/run_header.h"
#include "sampledb/read/byte_source.h"
#include "sampledb/read/damage.h"

namespace latent::sampledb {

struct RunWalk {
    std::vector<RunInfo> runs;   // ascending by offset
    std::vector<Damage> damage;  // bytes between runs, runs of other versions
    std::uint64_t end = 0;       // where the next run would begin
    bool footer = false;         // a footer begins there
};

// Walks from `begin`, the end of the header, to `end`: that of the file, or where a footer is known to begin. After damage it goes
// on at the next block that begins a run of the job. Errors: kIo; kUnsupported (more runs than are read);
// kCorrupt (of a file that is not on disk: no run in 256 MiB).
Result<RunWalk> walk_runs(const ByteSource& source, std::uint64_t begin, std::uint64_t end, const JobId& job);

// The run of the job that begins at `offset` and lies within the file. Errors: kTruncated if it is cut off, others if none begins
// there.
Result<RunInfo> read_run(const ByteSource& source, std::uint64_t offset, const JobId& job);

// `size` bytes at `offset`, or as many as there are.
Result<Bytes> read_up_to(const ByteSource& source, std::uint64_t offset, std::uint64_t size);

}  // namespace latent::sampledb
