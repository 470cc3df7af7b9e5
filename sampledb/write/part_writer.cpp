#include "sampledb/write/part_writer.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "sampledb/data/limits.h"
#include "sampledb/read/part_name.h"
#include "sampledb/write/committer.h"
#include "sampledb/write/earlier_attempts.h"
#include "sampledb/write/grain_window.h"
#include "sampledb/write/publisher.h"

namespace latent::sampledb {

struct PartWriter::Parts {
    Parts(const PartOptions& part_options, const Job& part_job, Coverage missing_grains)
        : options(part_options), job(part_job), missing(std::move(missing_grains)) {}

    const PartOptions options;
    const Job job;
    const Coverage missing;
    GrainWindow window{missing, options.range};
    Publisher publisher{options.path, job, options.range};
    std::optional<Committer> committer;  // none: NAME.latent was there
};

PartWriter::PartWriter(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
PartWriter::~PartWriter() = default;

Result<std::unique_ptr<PartWriter>> PartWriter::open(const PartOptions& options, const Job& job) {
    if (Status s = job.validate(); !s) return s.error();
    if (options.range.size() > kMaxRunsPerFile * job.run_samples) {
        return usage_error(fmt::format("samples {}:{}: more than {} runs of {} samples, the maximum of a part; write several parts",
                                       options.range.first, options.range.end, kMaxRunsPerFile, job.run_samples));
    }
    if (Status s = check_length(options.path); !s) return s.error();
    if (options.force) {
        if (Status s = remove_everything(options.path); !s) return s.error();
    }
    const Result<Published> published = look_at_published(options.path, job, options.range);
    if (!published) return published.error();
    if (*published == Published::kWhole) {
        auto parts = std::make_unique<Parts>(options, job, Coverage{});
        parts->window.close();
        return std::unique_ptr<PartWriter>(new PartWriter(std::move(parts)));
    }
    if (*published == Published::kInPart) {  // it gets a second name that stays when another file takes the first
        if (Status s = name_without_replacing(options.path, new_attempt(options.path)); !s) return s.error();
    }
    Result<EarlierAttempts> earlier = EarlierAttempts::find(options.path, job, options.range);
    if (!earlier) return earlier.error();
    Coverage missing(options.range);
    missing.remove(earlier->committed());
    auto parts = std::make_unique<Parts>(options, job, std::move(missing));
    if (Status s = parts->publisher.begin(options.provenance_json); !s) return s.error();
    Committer& committer = parts->committer.emplace(parts->job, options.range, options.checkpoint_seconds, std::move(*earlier),
                                                    parts->window, parts->publisher);
    if (Status s = committer.start(); !s) return s.error();
    return std::unique_ptr<PartWriter>(new PartWriter(std::move(parts)));
}

Result<Coverage> PartWriter::find_missing(const PartOptions& options, const Job& job) {
    if (Status s = check_length(options.path); !s) return s.error();
    Coverage missing(options.range);
    if (options.force) return missing;
    const Result<Published> published = look_at_published(options.path, job, options.range);
    if (!published) return published.error();
    if (*published == Published::kWhole) return Coverage{};
    const Result<EarlierAttempts> earlier = EarlierAttempts::find(options.path, job, options.range);
    if (!earlier) return earlier.error();
    missing.remove(earlier->committed());
    return missing;
}

const Coverage& PartWriter::missing() const { return parts_->missing; }

Status PartWriter::submit(Grain grain) {
    const Status taken = parts_->window.put(std::move(grain));
    if (published_elsewhere()) return {};
    if (Status s = parts_->committer->status(); !s) return s;
    if (!taken) return taken.error().at(parts_->options.path.string());
    return {};
}

void PartWriter::give_up() { parts_->window.give_up(); }

Status PartWriter::checkpoint() {
    parts_->window.flush();
    return parts_->committer ? parts_->committer->status() : Status{};
}

Status PartWriter::finish(const std::string& finished_json) {
    if (parts_->committer) {
        // Where another writer has published the part, the committer is about to close the window, if it has not yet.
        const Coverage unsubmitted = parts_->window.unsubmitted();
        if (!published_elsewhere() && !parts_->window.closed() && !unsubmitted.empty()) {
            return usage_error(
                fmt::format("{}: samples {} were not submitted", parts_->options.path.string(), to_string(unsubmitted)));
        }
        parts_->committer->wait();
        if (Status s = parts_->committer->status(); !s) return s;
    }
    if (!published_elsewhere()) {
        const std::string provenance = finished_json.empty() ? "" : fmt::format(R"({{"finished":{}}})", finished_json);
        if (Status s = parts_->publisher.publish(provenance); !s) return s;
    }
    parts_->publisher.remove_superfluous();
    return {};
}

bool PartWriter::published_elsewhere() const { return !parts_->committer || parts_->committer->published_elsewhere(); }

WriterCounts PartWriter::counts() const {
    if (parts_->committer) return parts_->committer->counts();
    WriterCounts counts;
    counts.samples_committed = parts_->options.range.size();
    return counts;
}

}  // namespace latent::sampledb
