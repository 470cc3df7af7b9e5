// sampledb/write/part_attempt.h: the file NAME.latent.part.<nonce> that one writer grows, and how it becomes NAME.latent.
#pragma once

#include <filesystem>
#include <vector>

#include "base/file.h"
#include "base/result.h"
#include "sampledb/format/file_header.h"
#include "sampledb/format/run_header.h"
#include "sampledb/write/earlier_attempts.h"

namespace latent::sampledb {

// Append-only: nothing that was written is ever touched again. Not thread-safe.
class PartAttempt {
 public:
    // A new file of its own under `name`, its header on disk. Errors: kIo, kNoSpace, kOutOfRange (header).
    static Result<PartAttempt> create(const std::filesystem::path& name, const FileHeader& header);

    // Appends a run and returns when it is on disk. Errors: kIo, kNoSpace; the file then ends in a torn run and takes no more.
    Status append(ByteSpan run);
    // The same with a run that another attempt holds, byte by byte.
    Status append(const StoredRun& run);

    // The name was removed, by another writer that published, or by the user.
    bool vanished() const;
    // Everything that was appended, under a new name.
    Status restore();

    // Writes the footer, with this provenance, and gives the file its final name as well. Errors: kExists if that is taken,
    // kNotFound if the attempt vanished, kIo, kNoSpace.
    Status publish(const std::string& provenance);

    std::uint64_t size() const { return end_; }
    const std::vector<RunInfo>& runs() const { return runs_; }
    const std::filesystem::path& path() const { return file_.path(); }
    const File& file() const { return file_; }

 private:
    Status check_room() const;
    Status commit(const RunHeader& header);

    std::filesystem::path name_;
    File file_;
    std::uint64_t end_ = 0;  // where the next run begins
    std::vector<RunInfo> runs_;
    bool has_footer_ = false;
};

}  // namespace latent::sampledb
