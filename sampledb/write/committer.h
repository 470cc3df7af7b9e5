// sampledb/write/committer.h: the thread that makes runs of grains, encodes them and puts them on disk.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "base/bytes.h"
#include "base/result.h"
#include "sampledb/codec/run_codec.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/job.h"
#include "sampledb/write/checkpoint_clock.h"
#include "sampledb/write/earlier_attempts.h"
#include "sampledb/write/grain_window.h"
#include "sampledb/write/publisher.h"
#include "sampledb/write/run_assembler.h"
#include "sampledb/write/writer_counts.h"

namespace latent::sampledb {

// Takes the grains of `range` in order, from earlier attempts and from the window. Commits a run when it is complete, and what is
// there of the next when a checkpoint is due. The window and the publisher are the thread's until it ends.
class Committer {
 public:
    Committer(const Job& job, SampleRange range, double checkpoint_seconds, EarlierAttempts earlier, GrainWindow& window,
              Publisher& publisher);
    ~Committer();  // ends the thread after the commit it is at
    Committer(const Committer&) = delete;
    Committer& operator=(const Committer&) = delete;

    // Errors: kIo, the system refuses a thread.
    Status start();
    // Returns when the thread has ended: the range is committed, an error was met or another writer has published it. The window is
    // closed then.
    void wait();

    // Any thread.
    Status status() const;                                   // the error that ended the thread
    bool published_elsewhere() const { return published_; }  // looked at after every commit
    WriterCounts counts() const;

 private:
    Status run();
    Result<bool> add_next();
    Status close(std::vector<AssembledRun> runs);
    Status checkpoint();
    Status commit(std::vector<GrainPtr> grains, std::uint64_t end, std::uint64_t WriterCounts::*counter);

    const Job& job_;
    const SampleRange range_;
    GrainWindow& window_;
    Publisher& publisher_;

    // The thread's own.
    EarlierAttempts earlier_;
    RunAssembler assembler_;
    std::vector<GrainWindow::Submitted> unsaved_;  // taken from the window, in no run on disk
    std::vector<GrainWindow::Submitted> again_;    // from earlier attempts: to be saved together with the next of these
    CheckpointClock clock_;
    RunBuilder builder_;
    Bytes encoded_;  // the run that was written last; its memory serves the next

    mutable std::mutex mutex_;  // guards these
    Coverage committed_;
    WriterCounts counts_;
    Status status_;

    std::atomic<bool> published_ = false;
    std::thread thread_;
};

}  // namespace latent::sampledb
