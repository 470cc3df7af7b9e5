#include "tools/inspect/gen.h"

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>

#include <charconv>
#include <chrono>
#include <mutex>
#include <optional>

#include "base/parallel.h"
#include "base/size.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

// The grains of what is missing, in ascending order, for any number of threads.
class GrainQueue {
 public:
    GrainQueue(const Coverage& missing, SampleRange range) : missing_(missing), range_(range) {}
    std::optional<SampleRange> next() {
        const std::lock_guard lock(mutex_);
        while (interval_ < missing_.ranges().size()) {
            const SampleRange& interval = missing_.ranges()[interval_];
            const std::uint64_t first = std::max(next_, interval.first);
            if (first >= interval.end) {
                ++interval_;
                continue;
            }
            next_ = std::min(interval.end, first - first % kGrainSamples + kGrainSamples);
            return SampleRange{first, next_};
        }
        return std::nullopt;
    }

 private:
    std::mutex mutex_;
    const Coverage& missing_;
    const SampleRange range_;
    std::size_t interval_ = 0;
    std::uint64_t next_ = 0;
};

}  // namespace
}  // namespace latent::inspect
