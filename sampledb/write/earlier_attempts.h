// sampledb/write/earlier_attempts.h: what other attempts under a name have committed of a range, so that it need not be rendered
// again.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "base/result.h"
#include "sampledb/format/run_header.h"
#include "sampledb/write/run_assembler.h"

namespace latent::sampledb {

// A run that some file holds. Files are opened when they are needed: there may be more of them than a process may have open.
struct StoredRun {
    std::filesystem::path file;
    RunInfo run;
    SampleRange samples() const { return run.header.samples; }
};

// The same run in another file under `name`, for when its own is gone.
std::optional<StoredRun> find_again(const std::filesystem::path& name, const StoredRun& run);

// Canonical runs that end at a multiple of S stand as they are. The others (checkpoints, closing runs, runs cut at R) give their
// grains back, so that runs end where they would have ended without any interruption.
class EarlierAttempts {
 public:
    EarlierAttempts() = default;

    // Looks at every attempt under `name`, and at `name` itself. What cannot be read is passed over: it is rendered again.
    // Canonical runs are accepted if every stored byte is sound; the others are decoded, unless they are larger than any of the job
    // should be. Errors: kMismatch if an attempt is of another job.
    static Result<EarlierAttempts> find(const std::filesystem::path& name, const Job& job, SampleRange range);

    // The samples that need not be rendered: whole grains.
    const Coverage& committed() const { return committed_; }

    // The canonical run that begins at `sample`; null if there is none.
    const StoredRun* canonical_at(std::uint64_t sample) const;
    // The grain that begins at `sample`, from its run, which is read again; null if there is none. Each grain is given once.
    struct Taken {
        GrainPtr grain;
        // Its run also holds a piece of a grain, which is rendered again as a whole. No reader can use both: the next checkpoint is
        // to hold this grain too, and so all that the run holds.
        bool save_again = false;
    };
    Result<Taken> take_grain(std::uint64_t sample);
    // A run of exactly these samples, should they turn out to be a run of the result; null if there is none.
    const StoredRun* run_of(SampleRange samples) const;

 private:
    struct LooseGrains {
        StoredRun stored;
        Coverage grains;
        bool with_piece = false;
    };

    void add(const StoredRun& stored);
    void keep_sound_runs();

    Job job_;
    SampleRange range_;
    std::map<std::uint64_t, StoredRun> canonical_;  // by first sample: a run from there to a multiple of S can only have one end
    std::map<SampleRange, StoredRun> others_;
    std::vector<LooseGrains> loose_;
    std::map<std::uint64_t, Taken> grains_;  // read, not yet taken; by first sample
    Coverage committed_;
};

}  // namespace latent::sampledb
