#include "sampledb/write/publisher.h"

#include <unistd.h>

#include <span>
#include <utility>

#include "sampledb/read/part_name.h"

namespace latent::sampledb {

Publisher::Publisher(std::filesystem::path name, const Job& job, SampleRange range)
    : name_(std::move(name)), job_(job), range_(range) {}

Publisher::~Publisher() {
    if (attempt_ && attempt_->runs().empty()) ::unlink(attempt_->path().c_str());
}

Status Publisher::begin(const std::string& provenance_json) {
    Result<PartAttempt> attempt = PartAttempt::create(name_, {job_, provenance_json});
    if (!attempt) return attempt.error();
    attempt_ = std::move(*attempt);
    return {};
}

Status Publisher::append(ByteSpan run) {
    if (Status s = attempt_->append(run); !s) return s;
    if (attempt_->vanished() && !published_elsewhere()) return attempt_->restore();
    return {};
}

Status Publisher::publish(const std::string& provenance) {
    Status done = copy_adopted();
    if (done) done = give_name(provenance);
    return done || published_elsewhere() ? Status{} : done;
}

// What was copied is read again: file systems have been seen to copy zeros.
Status Publisher::copy_adopted() {
    for (const StoredRun& run : adopted_) {
        Status copied = attempt_->append(run);
        if (!copied && copied.error().code == ErrorCode::kNotFound) {  // others may have made its file superfluous
            if (const std::optional<StoredRun> again = find_again(name_, run)) copied = attempt_->append(*again);
        }
        if (!copied) return copied;
    }
    if (adopted_.empty()) return {};
    const FileView written(attempt_->file(), attempt_->path().string(), attempt_->size());
    for (const RunInfo& run : std::span(attempt_->runs()).last(adopted_.size())) {
        if (Status s = verify_run(written, run, job_, VerifyLevel::kStored); !s) return s.error().at(written.name());
    }
    return {};
}

Status Publisher::give_name(const std::string& provenance) {
    for (;;) {
        const Status named = attempt_->publish(provenance);
        if (named) return {};
        const Result<Published> published = look_at_published(name_, job_, range_);
        if (!published) return published.error();  // the name went to another job or range
        if (*published == Published::kWhole) return {};
        if (attempt_->vanished()) {
            if (Status s = attempt_->restore(); !s) return s;
        } else if (*published == Published::kInPart) {
            if (Status s = make_attempt_of(name_); !s) return s;
        } else {
            return named;
        }
    }
}

void Publisher::remove_superfluous() const { remove_superfluous_attempts(name_, job_, Coverage(range_)); }

bool Publisher::published_elsewhere() const {
    const Result<Published> published = look_at_published(name_, job_, range_);
    return published && *published == Published::kWhole;
}

}  // namespace latent::sampledb
