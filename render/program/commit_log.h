// render/program/commit_log.h: the lines of latent-render in a log, such as that of a batch job: one for each commit.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace latent::render {

struct Committed {
    std::uint64_t samples = 0;      // in the range, earlier work included
    std::uint64_t bytes = 0;        // written now
    double samples_per_second = 0;  // rendered now
};

class CommitLog {
 public:
    using Clock = std::chrono::steady_clock;

    // `range`: samples in all. Commits that follow each other faster than `interval` share a line.
    CommitLog(std::uint64_t range, double interval_seconds) : range_(range), interval_(interval_seconds) {}

    // "committed 65536 of 262144 samples (25.0 %), 1h02m left, 0.053 M samples/s, 12.0 MiB written"; empty if there is nothing new
    // to say, or it is too soon. The last line (`final`) comes at once.
    std::string line(const Committed& committed, Clock::time_point now, bool final = false);

 private:
    const std::uint64_t range_;
    const std::chrono::duration<double> interval_;
    std::uint64_t said_ = 0;
    std::optional<Clock::time_point> last_;
};

}  // namespace latent::render
