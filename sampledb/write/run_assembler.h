// sampledb/write/run_assembler.h: grains in ascending order become runs, whose boundaries follow from the records alone.
// docs/format.md, "Writing".
#pragma once

#include <memory>
#include <vector>

#include "sampledb/data/coverage.h"
#include "sampledb/data/grain.h"
#include "sampledb/data/job.h"

namespace latent::sampledb {

using GrainPtr = std::shared_ptr<const Grain>;

// A run that is complete and waits to be encoded.
struct AssembledRun {
    SampleRange samples;
    std::vector<GrainPtr> grains;
};

// A canonical run ends at a multiple of S = job.run_samples, or before the grain that would take it over R = job.run_bytes raw
// bytes counted from the last boundary; a grain that is larger than R alone is a run alone. A range that ends elsewhere closes with
// one run up to its end. Neither threads nor restarts have a say: a grain that was committed before a restart is added again.
class RunAssembler {
 public:
    RunAssembler(const Job& job, SampleRange range);

    std::uint64_t next() const { return next_; }  // the sample number that the next grain begins with
    bool done() const { return next_ >= range_.end; }

    // Adds the grain that begins at next(). Returns the runs that end before it, at its end, or both.
    std::vector<AssembledRun> add(GrainPtr grain);
    // A canonical run that is stored already begins at next(), so the run before it ends here; returns that, if there is one.
    std::vector<AssembledRun> skip(SampleRange stored);

    // The grains of the run that is not complete yet, ascending.
    const std::vector<GrainPtr>& open_grains() const { return grains_; }

 private:
    void close(std::vector<AssembledRun>& closed);

    std::uint64_t run_samples_, run_bytes_;
    SampleRange range_;
    std::uint64_t next_;
    std::uint64_t boundary_;   // where the open run began
    std::uint64_t bytes_ = 0;  // raw bytes since then
    std::vector<GrainPtr> grains_;
};

// The grain of `range` that holds sample `sample`.
SampleRange grain_range(std::uint64_t sample, SampleRange range);

// The grains of `range` that `coverage` holds completely, cut out of `records`, which ascend by sample.
std::vector<GrainPtr> split(const Records& records, const Coverage& coverage, SampleRange range);

}  // namespace latent::sampledb
