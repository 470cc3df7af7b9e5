#include "sampledb/write/part_writer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <thread>

#include "base/parallel.h"
#include "sampledb/codec/run_codec.h"
#include "sampledb/read/part_name.h"
#include "sampledb/write/checkpoint_clock.h"
#include "sampledb/write/part_attempt.h"
#include "sampledb/write/run_assembler.h"

namespace latent::sampledb {

namespace {

using Clock = CheckpointClock::Clock;

constexpr std::uint64_t kWindowBytes = std::uint64_t{64} << 20;  // grains that wait for an older one
constexpr std::uint64_t kGrainOverhead = 1024;                   // what an empty grain costs

// Rendering threads `submit`; whoever completes a run hands it to the committer, a thread that encodes, writes and syncs. One run
// is assembled while another is encoded: never more than these two are held. Should a commit be late, because the disk is slow or
// the processors are taken, `submit` waits for it: so what SIGKILL may cost is bounded whatever the machine does.
class Writer final : public PartWriter {
 public:
    Writer(const PartOptions& options, const Job& job) : options_(options), job_(job), assembler_(job_, options_.range) {}
    ~Writer() override;

    Status begin(bool published);

    const Coverage& missing() const override { return missing_; }
    Status submit(Grain grain) override;
    void give_up() override;
    Status checkpoint() override;
    Status finish() override;
    bool published_elsewhere() const override;
    WriterCounts counts() const override;

 private:
    using Lock = std::unique_lock<std::mutex>;

    bool must_wait_for_a_commit(const Grain& grain) const;
    Clock::time_point in_order_until() const;
    void advance(Lock& lock);
    Result<GrainPtr> next_grain();
    void hand_over(AssembledRun run, Lock& lock);
    void commit_until_stopped();
    Status commit(std::vector<GrainPtr> grains, const Coverage& coverage);
    std::vector<GrainPtr> uncommitted() const;
    void stop_committer();
    Status add_runs_of_other_attempts();
    Status publish();
    bool published_by_another();
    Status status() const;
    bool over() const { return error_ || published_; }

    const PartOptions options_;
    const Job job_;
    Coverage missing_;
    std::optional<PartAttempt> attempt_;  // the committer's, then finish's
    Bytes encoded_;                       // the committer's: the run that was written last; its memory serves the next

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    RunAssembler assembler_;
    EarlierAttempts earlier_;
    std::vector<StoredRun> adopted_;  // runs of the result that earlier attempts hold
    struct Waiting {
        GrainPtr grain;
        Clock::time_point since;
    };
    std::map<std::uint64_t, Waiting> waiting_;  // submitted, not yet in their turn; by first sample
    std::uint64_t waiting_bytes_ = 0;           // of these
    Coverage unsubmitted_;
    Coverage committed_;
    bool advancing_ = false;             // a thread is moving grains into runs
    std::optional<AssembledRun> ready_;  // a complete run, not yet taken by the committer
    Clock::time_point ready_until_;      // what was submitted before is in it
    bool committing_ = false;
    bool checkpoint_wanted_ = false;
    bool unsaved_ = false;  // the run that is being assembled has a grain that no commit has taken yet
    CheckpointClock clock_{options_.checkpoint_seconds, Clock::now()};
    bool published_ = false;  // NAME.latent holds the range, whoever made it
    bool given_up_ = false;
    bool stop_ = false;
    std::optional<Error> error_;
    WriterCounts counts_;
    std::thread committer_;
};

Writer::~Writer() {
    stop_committer();
    if (attempt_ && attempt_->runs().empty()) ::unlink(attempt_->path().c_str());
}

Status Writer::begin(bool published) {
    if (published) {
        published_ = true;
        committed_ = Coverage(options_.range);
        return {};
    }
    Result<EarlierAttempts> earlier = EarlierAttempts::find(options_.path, job_, options_.range);
    if (!earlier) return earlier.error();
    earlier_ = std::move(*earlier);
    committed_ = earlier_.committed();
    missing_ = Coverage(options_.range);
    missing_.remove(committed_);
    unsubmitted_ = missing_;
    Result<PartAttempt> attempt = PartAttempt::create(options_.path, {job_, options_.provenance_json});
    if (!attempt) return attempt.error();
    attempt_ = std::move(*attempt);
    Result<std::thread> committer = start_thread([this] { commit_until_stopped(); });
    if (!committer) return committer.error();
    committer_ = std::move(*committer);
    Lock lock(mutex_);
    advance(lock);
    return status();
}

Status Writer::submit(Grain grain) {
    const std::uint64_t size = grain.records.raw_bytes() + kGrainOverhead;
    Lock lock(mutex_);
    const auto has_room = [&] {
        return waiting_bytes_ + size <= kWindowBytes || (!advancing_ && grain.range.first == assembler_.next());
    };
    changed_.wait(lock, [&] { return over() || given_up_ || (has_room() && !must_wait_for_a_commit(grain)); });
    if (over()) return status();
    if (!has_room()) return Error{ErrorCode::kStopped, options_.path.string() + ": stopped before an older grain was finished"};
    if (grain.range.empty() || !unsubmitted_.contains(grain.range) ||
        grain.range != grain_range(grain.range.first, options_.range)) {
        return Error{ErrorCode::kOutOfRange, fmt::format("{}: samples {} are not a missing grain", options_.path.string(),
                                                         to_string(Coverage(grain.range)))};
    }
    unsubmitted_.remove(grain.range);
    waiting_bytes_ += size;
    waiting_.emplace(grain.range.first, Waiting{std::make_shared<const Grain>(std::move(grain)), Clock::now()});
    if (!advancing_) advance(lock);
    return status();
}

void Writer::give_up() {
    const Lock lock(mutex_);
    given_up_ = true;
    changed_.notify_all();
}

// Moves grains into runs, in order, as far as they are there. One thread at a time does this, for all.
void Writer::advance(Lock& lock) {
    advancing_ = true;
    while (!over() && !assembler_.done()) {
        std::vector<AssembledRun> closed;
        if (const StoredRun* const stored = earlier_.canonical_at(assembler_.next())) {
            closed = assembler_.skip(stored->samples());
            adopted_.push_back(*stored);
        } else {
            const Result<GrainPtr> grain = next_grain();
            if (!grain && published_by_another()) break;
            if (!grain) error_ = grain.error();
            if (!grain || !*grain) break;
            closed = assembler_.add(*grain);
            if (!closed.empty()) unsaved_ = false;
            if (!unsaved_ && !assembler_.open_grains().empty() && !committed_.contains((*grain)->range)) {
                unsaved_ = true;
                changed_.notify_all();
            }
        }
        for (AssembledRun& run : closed) hand_over(std::move(run), lock);
    }
    advancing_ = false;
    changed_.notify_all();
}

// The grain whose turn it is, or null if it was not submitted yet.
Result<GrainPtr> Writer::next_grain() {
    Result<GrainPtr> earlier = earlier_.take_grain(assembler_.next());
    if (!earlier || *earlier) return earlier;
    const auto at = waiting_.find(assembler_.next());
    if (at == waiting_.end()) return GrainPtr();
    waiting_bytes_ -= at->second.grain->records.raw_bytes() + kGrainOverhead;
    changed_.notify_all();
    return std::move(waiting_.extract(at).mapped().grain);
}

// Gives a complete run to the committer, which must have finished the one before: so at most two are held.
void Writer::hand_over(AssembledRun run, Lock& lock) {
    if (const StoredRun* const stored = earlier_.run_of(run.samples)) return adopted_.push_back(*stored);
    const Clock::time_point until = in_order_until();
    changed_.wait(lock, [&] { return over() || (!ready_ && !committing_); });
    if (over()) return;
    ready_ = std::move(run);
    ready_until_ = until;
    changed_.notify_all();
}

std::vector<GrainPtr> Writer::uncommitted() const {
    std::vector<GrainPtr> grains;
    for (const GrainPtr& grain : assembler_.open_grains()) {
        if (!committed_.contains(grain->range)) grains.push_back(grain);
    }
    return grains;
}

// More than the checkpoint interval of work is at stake. If all of it waits for an older grain, only that one may pass.
bool Writer::must_wait_for_a_commit(const Grain& grain) const {
    const bool at_stake = unsaved_ || ready_ || committing_ || (!waiting_.empty() && grain.range.first != assembler_.next());
    return at_stake && clock_.late(Clock::now());
}

// A commit that is taken now holds everything that was submitted before; later grains may wait for an older one.
Clock::time_point Writer::in_order_until() const {
    Clock::time_point until = Clock::now();
    for (const auto& [first, waiting] : waiting_) until = std::min(until, waiting.since);
    return until;
}

void Writer::commit_until_stopped() {
    Lock lock(mutex_);
    while (!stop_ && !over()) {
        const bool checkpoint = !ready_ && unsaved_ && (checkpoint_wanted_ || Clock::now() >= clock_.due());
        if (!ready_ && !checkpoint) {
            if (unsaved_) {
                changed_.wait_until(lock, clock_.due());
            } else {
                changed_.wait(lock);
            }
            continue;
        }
        const Clock::time_point begin = Clock::now(), until = checkpoint ? in_order_until() : ready_until_;
        std::vector<GrainPtr> grains = checkpoint ? uncommitted() : std::move(ready_->grains);
        if (checkpoint) unsaved_ = checkpoint_wanted_ = false;
        ready_.reset();
        Coverage coverage;
        for (const GrainPtr& grain : grains) coverage.add(grain->range);

        committing_ = true;
        lock.unlock();
        const Status done = caught([&] { return commit(std::move(grains), coverage); });
        lock.lock();
        committing_ = false;
        if (done) {
            committed_.add(coverage);
            clock_.committed(until, begin, Clock::now());
            ++(checkpoint ? counts_.checkpoints_written : counts_.runs_written);
            counts_.bytes_written = attempt_->size();
        } else {
            error_ = done.error();
        }
        changed_.notify_all();
    }
}

// Encodes a run, and returns when it is on disk under a name that others can find.
Status Writer::commit(std::vector<GrainPtr> grains, const Coverage& coverage) {
    Pieces pieces;
    for (GrainPtr& grain : grains) {
        const Records* const records = &grain->records;
        pieces.emplace_back(std::move(grain), records);
    }
    Result<Bytes> run = encode_run(job_, coverage, std::move(pieces), std::move(encoded_));
    if (!run) return run.error();
    encoded_ = std::move(*run);
    if (Status s = attempt_->append(encoded_); !s) {
        return Error{s.error().code, s.error().message + "; committed work is kept: run the same command again to resume"};
    }
    {
        const Lock lock(mutex_);
        if (published_by_another()) return {};
    }
    return attempt_->vanished() ? attempt_->restore() : Status{};
}

Status Writer::checkpoint() {
    Lock lock(mutex_);
    const SampleRange finished{options_.range.first, assembler_.next()};
    while (!over() && !finished.empty() && !committed_.contains(finished)) {
        checkpoint_wanted_ = true;
        changed_.notify_all();
        changed_.wait(lock);
    }
    checkpoint_wanted_ = false;
    return status();
}

Status Writer::finish() {
    {
        Lock lock(mutex_);
        if (!over() && !unsubmitted_.empty()) {
            return Error{ErrorCode::kUsage,
                         fmt::format("{}: samples {} were not submitted", options_.path.string(), to_string(unsubmitted_))};
        }
        changed_.wait(lock, [&] { return over() || (assembler_.done() && !advancing_ && !ready_ && !committing_); });
        if (Status s = status(); !s) return s;
    }
    stop_committer();
    if (!published_) {
        Status done = add_runs_of_other_attempts();
        if (done) done = publish();
        if (!done && !published_by_another()) return done;
    }
    remove_superfluous_attempts(options_.path, job_, Coverage(options_.range));
    return {};
}

// Whether another writer of the same name and range was faster: then nothing is lost, whatever happened to this one's files.
bool Writer::published_by_another() {
    const Result<bool> published = is_published(options_.path, job_, options_.range);
    published_ = published && *published;
    return published_;
}

// Copies what other attempts hold of the result, and reads the copies again: file systems have been seen to copy zeros.
Status Writer::add_runs_of_other_attempts() {
    for (const StoredRun& run : adopted_) {
        if (Status s = attempt_->append(run); !s) return s;
    }
    if (adopted_.empty()) return {};
    const FileView written(attempt_->file(), attempt_->path().string(), attempt_->size());
    for (const RunInfo& run : std::span(attempt_->runs()).last(adopted_.size())) {
        if (Status s = verify_run(written, run, job_, VerifyLevel::kStored); !s) return s.error().at(written.name());
    }
    return {};
}

Status Writer::publish() {
    for (;;) {
        const Status named = attempt_->publish();
        if (named) return {};
        const Result<bool> published = is_published(options_.path, job_, options_.range);
        if (!published) return published.error();  // the name went to another job or range
        if (*published) return {};
        if (!attempt_->vanished()) return named;
        if (Status s = attempt_->restore(); !s) return s;
    }
}

void Writer::stop_committer() {
    {
        const Lock lock(mutex_);
        stop_ = true;
        changed_.notify_all();
    }
    if (committer_.joinable()) committer_.join();
}

Status Writer::status() const {
    if (error_) return *error_;
    return {};
}

bool Writer::published_elsewhere() const {
    const Lock lock(mutex_);
    return published_;
}

WriterCounts Writer::counts() const {
    const Lock lock(mutex_);
    WriterCounts counts = counts_;
    counts.samples_committed = published_ ? options_.range.size() : committed_.size();
    return counts;
}

}  // namespace

Result<std::unique_ptr<PartWriter>> PartWriter::open(const PartOptions& options, const Job& job) {
    if (Status s = job.validate(); !s) return s.error();
    const std::uint64_t below = options.range.first - options.range.first % job.run_samples;
    if (!options.range.empty() && below != options.range.first) {
        return Error{ErrorCode::kUsage,
                     fmt::format("samples {}:{}: a part must begin at a multiple of the run length {}; the nearest are {} and {}",
                                 options.range.first, options.range.end, job.run_samples, below, below + job.run_samples)};
    }
    if (options.range.size() > kMaxRunsPerFile * job.run_samples) {
        return Error{ErrorCode::kUsage,
                     fmt::format("samples {}:{}: more than {} runs of {} samples, the maximum of a part; write several parts",
                                 options.range.first, options.range.end, kMaxRunsPerFile, job.run_samples)};
    }
    if (options.force) {
        if (Status s = remove_everything(options.path); !s) return s.error();
    }
    const Result<bool> published = is_published(options.path, job, options.range);
    if (!published) return published.error();
    auto writer = std::make_unique<Writer>(options, job);
    if (Status s = writer->begin(*published); !s) return s.error();
    return writer;
}

Result<Coverage> PartWriter::find_missing(const PartOptions& options, const Job& job) {
    Coverage missing(options.range);
    if (options.force) return missing;
    const Result<bool> published = is_published(options.path, job, options.range);
    if (!published) return published.error();
    if (*published) return Coverage{};
    const Result<EarlierAttempts> earlier = EarlierAttempts::find(options.path, job, options.range);
    if (!earlier) return earlier.error();
    missing.remove(earlier->committed());
    return missing;
}

}  // namespace latent::sampledb
