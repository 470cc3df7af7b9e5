// sampledb/write/publisher.h: the file of a part: an attempt that grows run by run, and becomes NAME.latent.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/job.h"
#include "sampledb/write/part_attempt.h"

namespace latent::sampledb {

// Not thread-safe.
class Publisher {
 public:
    // `name`: NAME.latent, which is to hold `range`.
    Publisher(std::filesystem::path name, const Job& job, SampleRange range);
    ~Publisher();  // an attempt without runs is removed
    Publisher(const Publisher&) = delete;
    Publisher& operator=(const Publisher&) = delete;

    // Makes a new attempt. Errors: those of PartAttempt::create.
    Status begin(const std::string& provenance_json);
    // Appends a run. When this returns it is on disk, under a name that others can find. Errors: kIo, kNoSpace.
    Status append(ByteSpan run);
    // A run of the result that another attempt holds. It is copied at the end: until then it is safe where it is.
    void adopt(const StoredRun& run) { adopted_.push_back(run); }
    // Copies the adopted runs, and names the file NAME.latent, with this provenance in its footer. It is no error if another writer
    // has done so. Errors: kIo, kNoSpace, kMismatch (the name went to another job or range), and those of a run that can no longer
    // be read.
    Status publish(const std::string& provenance);
    // Removes the attempts that NAME.latent makes superfluous.
    void remove_superfluous() const;

    // Whether NAME.latent holds the range, whoever made it. Then nothing is lost, whatever happens to this attempt.
    bool published_elsewhere() const;
    std::uint64_t bytes_written() const { return attempt_ ? attempt_->size() : 0; }

 private:
    Status copy_adopted();
    Status give_name(const std::string& provenance);

    const std::filesystem::path name_;
    const Job& job_;
    const SampleRange range_;
    std::optional<PartAttempt> attempt_;
    std::vector<StoredRun> adopted_;
};

}  // namespace latent::sampledb
