#include "sampledb/write/committer.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/parallel.h"

namespace latent::sampledb {

namespace {

using Clock = CheckpointClock::Clock;

}  // namespace

Committer::Committer(const Job& job, SampleRange range, double checkpoint_seconds, EarlierAttempts earlier, GrainWindow& window,
                     Publisher& publisher)
    : job_(job),
      range_(range),
      window_(window),
      publisher_(publisher),
      earlier_(std::move(earlier)),
      assembler_(job, range),
      clock_(checkpoint_seconds, Clock::now()),
      committed_(earlier_.committed()) {}

Committer::~Committer() {
    window_.close();
    wait();
}

Status Committer::start() {
    window_.saved(range_.first, clock_.late_at());
    Result<std::thread> thread = start_thread([this] {
        Status ended = caught([&] { return run(); });
        {
            const std::lock_guard lock(mutex_);
            status_ = std::move(ended);
        }
        window_.close();
    });
    if (!thread) return thread.error();
    thread_ = std::move(*thread);
    return {};
}

void Committer::wait() {
    if (thread_.joinable()) thread_.join();
}

Status Committer::run() {
    while (!assembler_.done() && !published_) {
        const Result<bool> added = add_next();
        if (!added) return added.error();
        if (window_.closed()) break;
        if (!*added) {
            if (Status s = checkpoint(); !s) return s;
        }
    }
    return {};
}

// Adds what begins at the next sample to the runs; false if it is time for a checkpoint instead.
Result<bool> Committer::add_next() {
    const std::uint64_t next = assembler_.next();
    if (const StoredRun* const stored = earlier_.canonical_at(next)) {
        publisher_.adopt(*stored);
        if (Status s = close(assembler_.skip(stored->samples())); !s) return s.error();
        return true;
    }
    Result<EarlierAttempts::Taken> earlier = earlier_.take_grain(next);
    if (!earlier) {
        published_ = publisher_.published_elsewhere();
        if (!published_) return earlier.error();
        return true;
    }
    GrainPtr grain = std::move(earlier->grain);
    if (!grain) {
        GrainWindow::Submitted taken = window_.take(next, unsaved_.empty() ? GrainWindow::Time::max() : clock_.due());
        if (!taken.grain) return false;
        grain = taken.grain;
        std::ranges::move(std::exchange(again_, {}), std::back_inserter(unsaved_));
        unsaved_.push_back(std::move(taken));
    } else if (earlier->save_again) {
        again_.push_back({grain, Clock::now()});
    }
    if (Status s = close(assembler_.add(std::move(grain))); !s) return s.error();
    return true;
}

Status Committer::close(std::vector<AssembledRun> runs) {
    for (AssembledRun& run : runs) {
        if (const StoredRun* const stored = earlier_.run_of(run.samples)) {
            publisher_.adopt(*stored);
            continue;
        }
        const auto held = [&](const GrainWindow::Submitted& taken) { return taken.grain->range.end <= run.samples.end; };
        std::erase_if(unsaved_, held);
        std::erase_if(again_, held);
        if (Status s = commit(std::move(run.grains), run.samples.end, &WriterCounts::runs_written); !s) return s;
    }
    return {};
}

Status Committer::checkpoint() {
    std::vector<GrainPtr> grains;
    for (GrainWindow::Submitted& taken : std::exchange(unsaved_, {})) grains.push_back(std::move(taken.grain));
    if (!grains.empty()) return commit(std::move(grains), assembler_.next(), &WriterCounts::checkpoints_written);
    window_.saved(assembler_.next(), clock_.late_at());
    return {};
}

// Puts a run on disk, after which everything before sample `end` is there.
Status Committer::commit(std::vector<GrainPtr> grains, std::uint64_t end, std::uint64_t WriterCounts::*counter) {
    const Clock::time_point begin = Clock::now();
    Clock::time_point until = std::min(begin, window_.oldest());  // grains that came before are in this run or an earlier one
    for (const GrainWindow::Submitted& left : unsaved_) until = std::min(until, left.since);
    Coverage coverage;
    Pieces pieces;
    for (GrainPtr& grain : grains) {
        coverage.add(grain->range);
        const Records* const records = &grain->records;
        pieces.emplace_back(std::move(grain), records);
    }
    Result<Bytes> run = builder_.build(job_, coverage, std::move(pieces), std::move(encoded_));
    if (!run) return run.error();
    encoded_ = std::move(*run);
    if (const Status s = publisher_.append(encoded_); !s) {
        const char* const left =
            committed_.empty() ? "nothing is committed yet" : "committed work is kept: run the same command again to resume";
        return Error{s.error().code, fmt::format("{}; {}", s.error().message, left)};
    }
    published_ = publisher_.published_elsewhere();
    {
        const std::lock_guard lock(mutex_);
        committed_.add(coverage);
        ++(counts_.*counter);
        counts_.bytes_written = publisher_.bytes_written();
    }
    clock_.committed(until, begin, Clock::now());
    window_.saved(end, clock_.late_at());
    return {};
}

Status Committer::status() const {
    const std::lock_guard lock(mutex_);
    return status_;
}

WriterCounts Committer::counts() const {
    const std::lock_guard lock(mutex_);
    WriterCounts counts = counts_;
    counts.samples_committed = published_ ? range_.size() : committed_.size();
    return counts;
}

}  // namespace latent::sampledb
