// sampledb/write/part_writer.h: writes the part of one process: grains in, runs out, resumable at any moment. docs/format.md,
// "Writing".
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/grain.h"
#include "sampledb/data/job.h"
#include "sampledb/write/writer_counts.h"

namespace latent::sampledb {

struct PartOptions {
    std::filesystem::path path;  // NAME.latent; the attempt is NAME.latent.part.<nonce>
    SampleRange range;
    double checkpoint_seconds = 60;  // that much rendering, and the grains in work, is the most that a kill may cost
    std::string provenance_json;     // host, date, version, scene: kept in this file's header only
    bool force = false;              // start over, whatever is there under this name
};

// A pipeline of three parts: grains wait in a GrainWindow, which puts them in order; a Committer makes runs of them on a thread of
// its own; a Publisher writes these to a file and gives it its name.
class PartWriter {
 public:
    // Looks at what is there under the name, opens a new attempt if anything is missing. A finished NAME.latent that holds a part
    // of the range, and nothing else, is extended: it stays until the longer one takes its name. Errors: kMismatch (NAME.latent is
    // of another job, or covers another range), kUsage (too many runs), kIo, kNoSpace.
    static Result<std::unique_ptr<PartWriter>> open(const PartOptions& options, const Job& job);
    // What `open` would find missing. Only looks. Errors: kMismatch, kIo.
    static Result<Coverage> find_missing(const PartOptions& options, const Job& job);
    ~PartWriter();  // what is not committed is lost
    PartWriter(const PartWriter&) = delete;
    PartWriter& operator=(const PartWriter&) = delete;

    // What was not committed when the part was opened, grain by grain in ascending order: render exactly these.
    const Coverage& missing() const;

    // Takes a finished grain; any thread, any order. Blocks while the grain is too far ahead of the oldest missing one or of the
    // disk, so memory stays bounded, and while a checkpoint is late. After an error every later call returns that error.
    Status submit(Grain grain);

    // The oldest missing grain will not come: wakes the calls of submit that wait for it. They let their grains go and return
    // kStopped.
    void give_up();

    // Commits the finished grains that no run holds yet (up to the first gap) as a checkpoint run. Any thread.
    Status checkpoint();

    // Everything missing was submitted: writes what is left, adds runs of other attempts, the footer, publishes NAME.latent, and
    // removes the attempts that it makes superfluous. `finished_json`: members that join the provenance of the header, a JSON
    // object; empty: none.
    Status finish(const std::string& finished_json = "");

    // Whether another writer has published NAME.latent with the whole range: nothing is left to render, and `finish` has little to
    // do. Looked at whenever a run or checkpoint has been committed.
    bool published_elsewhere() const;

    WriterCounts counts() const;

 private:
    struct Parts;
    explicit PartWriter(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

}  // namespace latent::sampledb
