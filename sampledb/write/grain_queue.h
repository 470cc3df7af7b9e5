// sampledb/write/grain_queue.h: the grains that a writer asks for, handed out one by one to any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>

#include "sampledb/data/coverage.h"

namespace latent::sampledb {

// The grains of a coverage (PartWriter::missing) in ascending order. Thread-safe.
class GrainQueue {
 public:
    explicit GrainQueue(Coverage coverage) : coverage_(std::move(coverage)) {}
    // The next grain, a part of one where an interval begins or ends inside it; empty when there are no more.
    SampleRange next();

 private:
    const Coverage coverage_;
    std::mutex mutex_;
    std::size_t interval_ = 0;
    std::uint64_t reached_ = 0;  // everything before is handed out
};

}  // namespace latent::sampledb
