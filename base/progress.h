// base/progress.h: how far a tool is: a bar on a terminal, now and then a line in a log.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "base/result.h"

namespace latent {

// Engines call this with the done part (0..1) and what else there is to say ("1.2 M samples/s, 3.4 GiB"). May be empty.
// Called from one thread at a time. An engine that resumes calls it before it begins, with the part that is there already.
using Progress = std::function<void(double done, const std::string& detail)>;

// Whether to give up: asked often, by any thread. Once true, it stays so. May be empty: never.
using Stopped = std::function<bool()>;
inline bool is_true(const Stopped& stopped) { return stopped && stopped(); }
inline Error given_up() { return {ErrorCode::kStopped, "given up"}; }

namespace cli {

// On a terminal, a bar on stderr with the time left, drawn at most ten times a second, in one row however narrow that is.
// Elsewhere, a line of a log every half minute.
Progress progress_to_stderr(std::string verb);

// The time that the rest takes at the pace since the first call: what was done before does not count.
class Pace {
 public:
    using Clock = std::chrono::steady_clock;
    void add(double done, Clock::time_point now);
    std::optional<double> seconds_left() const;  // once there is a pace

 private:
    std::optional<double> first_;
    double done_ = 0;
    Clock::time_point begin_, now_;
};

// "rendering [#####...]  37%  1h02m left  1.2 M samples/s", or less of it, in at most `columns`.
std::string progress_line(const std::string& verb, double done, const std::string& left, const std::string& detail,
                          std::size_t columns);

class ProgressLog {
 public:
    explicit ProgressLog(std::string verb) : verb_(std::move(verb)) {}
    // "rendering 37.5 %, 1h02m left, 1.2 M samples/s", once in half a minute; empty otherwise.
    std::string line(double done, const std::string& detail, Pace::Clock::time_point now);

 private:
    std::string verb_;
    Pace pace_;
    std::optional<Pace::Clock::time_point> last_;  // line, or the beginning
};

}  // namespace cli
}  // namespace latent
