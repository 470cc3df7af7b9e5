// sampledb/write/part_writer.h: writes the part of one process: grains in, runs out, resumable at any moment. docs/format.md,
// "Writing".
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/grain.h"
#include "sampledb/data/job.h"

namespace latent::sampledb {

struct PartOptions {
    std::filesystem::path path;      // NAME.latent; the attempt is NAME.latent.part.<nonce>
    SampleRange range;               // first is a multiple of run_samples
    double checkpoint_seconds = 60;  // that much rendering, and the grains in work, is the most that a kill may cost
    std::string provenance_json;     // host, date, version, scene: kept in this file's header only
    bool force = false;              // start over, whatever is there under this name
};

struct WriterCounts {
    std::uint64_t samples_committed = 0;  // of the range, by this and other attempts; all of it: there is nothing left to render
    std::uint64_t bytes_written = 0;
    std::uint64_t runs_written = 0, checkpoints_written = 0;
};

class PartWriter {
 public:
    // Looks at what is there under the name, opens a new attempt if anything is missing.
    // Errors: kMismatch (NAME.latent is of another job, or covers another range), kUsage (range.first; the message names the
    // nearest valid ones), kIo, kNoSpace.
    static Result<std::unique_ptr<PartWriter>> open(const PartOptions& options, const Job& job);
    // What `open` would find missing. Only looks. Errors: kMismatch, kIo.
    static Result<Coverage> find_missing(const PartOptions& options, const Job& job);
    virtual ~PartWriter() = default;

    // What was not committed when the part was opened, grain by grain in ascending order: render exactly these.
    virtual const Coverage& missing() const = 0;

    // Takes a finished grain; any thread, any order. Blocks while the grain is too far ahead of the oldest missing one or while
    // both buffers are full, so memory stays bounded, and while a checkpoint is late. After an error every later call returns that
    // error.
    virtual Status submit(Grain grain) = 0;

    // The oldest missing grain will not come: wakes the calls of submit that wait for it. They let their grains go and return
    // kStopped.
    virtual void give_up() = 0;

    // Commits the finished grains that no run holds yet (up to the first gap) as a checkpoint run. Any thread.
    virtual Status checkpoint() = 0;

    // Everything missing was submitted: writes what is left, adds runs of other attempts, the footer, publishes NAME.latent, and
    // removes the attempts that it makes superfluous.
    virtual Status finish() = 0;

    // Whether another writer has published NAME.latent with the whole range: nothing is left to render, and `finish` has little to
    // do. Looked at whenever a run or checkpoint has been committed.
    virtual bool published_elsewhere() const = 0;

    virtual WriterCounts counts() const = 0;
};

}  // namespace latent::sampledb
