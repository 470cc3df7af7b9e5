#include "sampledb/write/part_attempt.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/hidden_name.h"
#include "sampledb/data/limits.h"
#include "sampledb/format/footer.h"
#include "sampledb/read/part_name.h"

namespace latent::sampledb {

namespace {

namespace fs = std::filesystem;

}  // namespace

Result<PartAttempt> PartAttempt::create(const fs::path& name, const FileHeader& header) {
    const Result<Bytes> bytes = encode_file_header(header);
    if (!bytes) return bytes.error();
    Result<File> file = File::create_exclusive(new_attempt(name));
    if (!file) return file.error();
    PartAttempt attempt;
    attempt.name_ = name;
    attempt.file_ = std::move(*file);
    Status written = attempt.file_.write_all(0, *bytes);
    if (written) written = attempt.file_.sync_data();
    if (written) written = sync_folder(folder_of(name));
    if (!written) {
        ::unlink(attempt.path().c_str());
        return written.error();
    }
    attempt.end_ = bytes->size();
    return attempt;
}

// A file whose footer could not list all its runs would never be finished.
Status PartAttempt::check_room() const {
    if (runs_.size() < kMaxRunsPerFile) return {};
    return Error{ErrorCode::kOutOfRange, fmt::format("{}: {} runs, the maximum of a file", name_.string(), runs_.size())};
}

Status PartAttempt::append(ByteSpan run) {
    if (Status s = check_room(); !s) return s;
    const Result<RunHeader> header = decode_run_header(run);
    if (!header) return header.error();
    if (Status s = file_.write_all(end_, run); !s) return s;
    return commit(*header);
}

Status PartAttempt::append(const StoredRun& run) {
    if (Status s = check_room(); !s) return s;
    const Result<File> source = File::open_read(run.file);
    if (!source) return source.error();
    if (Status s = file_.copy_from(*source, run.run.offset, end_, run.run.header.size()); !s) return s;
    return commit(run.run.header);
}

Status PartAttempt::commit(const RunHeader& header) {
    if (Status s = file_.sync_data(); !s) return s;
    runs_.push_back({end_, header});
    end_ += header.size();
    return {};
}

bool PartAttempt::vanished() const {
    struct stat info;
    return ::fstat(file_.descriptor(), &info) == 0 && info.st_nlink == 0 && !is_named(file_.descriptor(), path());
}

Status PartAttempt::restore() {
    Result<File> file = File::create_exclusive(new_attempt(name_));
    if (!file) return file.error();
    if (Status s = file->copy_from(file_, 0, 0, end_); !s) return s;
    if (Status s = file->sync_data(); !s) return s;
    file_ = std::move(*file);
    has_footer_ = false;
    return sync_folder(folder_of(name_));
}

Status PartAttempt::publish(const std::string& provenance) {
    if (!has_footer_) {
        const Result<Bytes> footer = encode_footer(runs_, provenance, end_);
        if (!footer) return footer.error().at(name_.string());
        if (Status s = file_.write_all(end_, *footer); !s) return s;
        if (Status s = file_.sync_data(); !s) return s;
        has_footer_ = true;
    }
    if (Status s = name_without_replacing(path(), name_); !s) return s;
    return sync_folder(folder_of(name_));
}

}  // namespace latent::sampledb
