// base/stopwatch.h: seconds by the clock and of processors, for reports.
#pragma once

#include <chrono>
#include <ctime>

namespace latent {

class Stopwatch {
 public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

 private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point begin_ = Clock::now();
};

// Seconds of all processors that this process has used so far.
inline double cpu_seconds() {
    struct timespec used {};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

}  // namespace latent
