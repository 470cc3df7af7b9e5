// sampledb/write/checkpoint_clock.h: how much rendering a kill would cost now, and when to begin a checkpoint so that it is never
// more than the interval.
#pragma once

#include <algorithm>
#include <chrono>

namespace latent::sampledb {

// Times are those of the steady clock; the caller says which moment is now. Rendering stops while the clock is late.
class CheckpointClock {
 public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;
    using Duration = Clock::duration;

    CheckpointClock(double interval_seconds, Time now)
        : interval_(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(std::min(interval_seconds, 1e6)))),
          saved_at_(now),
          longest_commit_(interval_ / 8) {}

    // From when on an interval's work is at stake. Only a commit moves it on.
    Time late_at() const { return saved_at_ + interval_; }

    // When to begin a checkpoint: early by what a commit takes, so that it is on the disk before it is late.
    Time due() const { return late_at() - std::min(longest_commit_, interval_ / 2); }

    // A commit that began at `begin` is on the disk `now`, with everything that was rendered before `until`. What was rendered
    // since then, until the clock was late, is at stake.
    void committed(Time until, Time begin, Time now) {
        const Time waiting_since = std::max(until, late_at());
        saved_at_ = until + std::max(now - waiting_since, Duration::zero());
        longest_commit_ = std::max(longest_commit_, now - begin);
    }

 private:
    Duration interval_;
    Time saved_at_;  // what was rendered before is on the disk; moved on by the time that rendering waited
    Duration longest_commit_;
};

}  // namespace latent::sampledb
