// sampledb/write/grain_window.h: the grains between renderers and committer: they come in any order and leave in the order of their
// samples. Bounded in bytes, and in time: rendering waits for a disk that is late.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>

#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/write/checkpoint_clock.h"
#include "sampledb/write/run_assembler.h"

namespace latent::sampledb {

// Thread-safe: any number of threads put, one takes.
class GrainWindow {
 public:
    using Time = CheckpointClock::Time;
    struct Submitted {
        GrainPtr grain;
        Time since;
    };

    // `missing`: the grains of `range` that will be put, each once.
    GrainWindow(Coverage missing, SampleRange range);

    // Takes a grain. Waits for room: grains that wait for an older one take 64 MiB at most, and so do those that are in order; the
    // oldest missing one always finds room. Then waits until the disk is no longer late. Errors: kOutOfRange (not a missing
    // grain), kStopped (the grain was let go: the window is closed, or rendering was given up while there was no room).
    Status put(Grain grain);
    // The oldest missing grain will not come: no one waits for it any longer.
    void give_up();
    // Returns when every grain before the first that is missing is on disk, or the window is closed.
    void flush();
    // The grains that were not put yet.
    Coverage unsubmitted() const;

    // For the committer: the grain that begins at `sample`, once it is there. Null when it is time for a checkpoint instead: after
    // the deadline, or for `flush`, once what was in order by then has been taken. Null as well when the window is closed.
    Submitted take(std::uint64_t sample, Time deadline);
    // Since when the grain waits that has waited longest; Time::max() if none does.
    Time oldest() const;
    // Whatever was taken before sample `end` is on disk. `late_at`: when rendering must wait for the rest.
    void saved(std::uint64_t end, Time late_at);
    // Nothing is taken any more: every wait ends.
    void close();
    bool closed() const;

 private:
    using Lock = std::unique_lock<std::mutex>;

    std::uint64_t first_gap() const { return unsubmitted_.empty() ? range_.end : unsubmitted_.ranges().front().first; }
    bool has_room(std::uint64_t first, std::uint64_t size) const;
    bool at_stake() const { return !waiting_.empty() || taken_ > saved_; }

    const SampleRange range_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    Coverage unsubmitted_;
    std::map<std::uint64_t, Submitted> waiting_;                 // not yet taken; by first sample
    std::uint64_t in_order_bytes_ = 0, out_of_order_bytes_ = 0;  // bytes before the first gap, and behind it
    std::uint64_t taken_, saved_;                                // grains before these samples were taken, are on disk
    std::uint64_t flush_to_ = 0;                                 // grains before this one are wanted on disk at once
    Time late_at_ = Time::max();
    bool given_up_ = false, closed_ = false;
};

}  // namespace latent::sampledb
