#include "sampledb/write/grain_queue.h"

#include <algorithm>

#include "sampledb/data/grain.h"

namespace latent::sampledb {

SampleRange GrainQueue::next() {
    const std::lock_guard lock(mutex_);
    const std::span<const SampleRange> intervals = coverage_.ranges();
    while (interval_ < intervals.size() && reached_ >= intervals[interval_].end) ++interval_;
    if (interval_ == intervals.size()) return {};
    const std::uint64_t first = std::max(reached_, intervals[interval_].first);
    reached_ = std::min(intervals[interval_].end, first - first % kGrainSamples + kGrainSamples);
    return {first, reached_};
}

}  // namespace latent::sampledb
