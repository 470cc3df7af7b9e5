// tools/merge/output.h: the merged file as it grows, run by run; each is checked on the copy before it counts.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/result.h"
#include "sampledb/read/recent_cache.h"
#include "sampledb/read/run_set.h"
#include "tools/merge/plan.h"

namespace latent::merge {

class Output {
 public:
    // Copies and checks `piece` bytes at once; `threads` decode at level kFull, and compact within `memory`.
    Output(OutputFile& out, sampledb::VerifyLevel level, std::uint64_t piece, std::uint64_t memory, const Threads& threads,
           const Progress& progress)
        : out_(out), level_(level), piece_(piece), memory_(memory), threads_(threads), progress_(progress) {}

    Status begin(const sampledb::Job& job);

    // Appends what `plan` says. A step of which a run is damaged is left out, taken from the plan, and the run is returned.
    // Errors: kIo, kNoSpace; kCorrupt if what was read is sound and the copy is not.
    Result<std::vector<sampledb::DamagedRun>> append(const sampledb::RunSet& run_set, std::vector<Step>& plan);
    // Forgets all runs but the first `count`.
    void keep(std::size_t count);

    Status end(const std::string& provenance);

    const std::vector<sampledb::RunInfo>& runs() const { return runs_; }
    std::uint64_t size() const { return end_; }

 private:
    class Appending;

    OutputFile& out_;
    const sampledb::VerifyLevel level_;
    const std::uint64_t piece_, memory_;
    const Threads& threads_;
    const Progress& progress_;
    std::vector<sampledb::RunInfo> runs_;
    std::uint64_t end_ = 0, header_end_ = 0;
};

}  // namespace latent::merge
