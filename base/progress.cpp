#include "base/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string_view>

#include "base/size.h"
#include "base/terminal.h"

namespace latent::cli {

namespace {

using Clock = Pace::Clock;

std::string left_text(const Pace& pace) {
    const std::optional<double> seconds = pace.seconds_left();
    return seconds ? format_duration(*seconds) + " left" : "";
}

// Asked for at every drawing, which is often enough to follow a window that changes its size.
std::size_t terminal_columns() {
    struct winsize size {};
    return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

class Bar {
 public:
    explicit Bar(std::string verb) : verb_(std::move(verb)) {}
    ~Bar() {
        if (drawn_) fmt::print(stderr, "\r\033[K");
    }
    void show(double done, const std::string& detail) {
        const Clock::time_point now = Clock::now();
        pace_.add(done, now);
        if (drawn_ && done < 1 && now - last_ < std::chrono::milliseconds(100)) return;
        last_ = now;
        drawn_ = true;
        // The last column stays free: some terminals begin a row when it is filled.
        fmt::print(stderr, "\r\033[K{}", progress_line(verb_, done, left_text(pace_), detail, terminal_columns() - 1));
        std::fflush(stderr);
    }

 private:
    std::string verb_;
    Pace pace_;
    Clock::time_point last_;
    bool drawn_ = false;
};

}  // namespace

void Pace::add(double done, Clock::time_point now) {
    if (!first_) first_ = done, begin_ = now;
    done_ = done, now_ = now;
}

std::optional<double> Pace::seconds_left() const {
    const double elapsed = std::chrono::duration<double>(now_ - begin_).count();
    if (!first_ || elapsed < 1 || !(done_ > *first_)) return std::nullopt;
    return elapsed * (1 - done_) / (done_ - *first_);
}

std::string progress_line(const std::string& verb, double done, const std::string& left, const std::string& detail,
                          std::size_t columns) {
    constexpr std::size_t kMinBar = 8, kMaxBar = 24;
    const std::string percent = fmt::format("{:3.0f}%", std::clamp(done, 0.0, 1.0) * 100);
    std::string after = "  " + percent;
    std::size_t room = verb.size() + std::string_view(" []").size() + after.size() + kMinBar;
    for (const std::string& part : {left, detail}) {
        if (part.empty()) continue;
        if (room + 2 + part.size() > columns) break;  // the time left is worth more than what comes behind it
        after += "  " + part;
        room += 2 + part.size();
    }
    if (room <= columns) {
        const std::size_t bar = std::min(kMaxBar, kMinBar + columns - room);
        const auto filled = static_cast<std::size_t>(std::clamp(done, 0.0, 1.0) * static_cast<double>(bar));
        return fmt::format("{} [{}{}]{}", verb, std::string(filled, '#'), std::string(bar - filled, '.'), after);
    }
    if (verb.size() + 1 + percent.size() <= columns) return verb + " " + percent;
    return percent.size() <= columns ? percent : "";
}

std::string ProgressLog::line(double done, const std::string& detail, Clock::time_point now) {
    constexpr std::chrono::seconds kInterval(30);
    pace_.add(done, now);
    if (!last_) last_ = now;
    if (now - *last_ < kInterval) return "";
    last_ = now;
    std::string line = fmt::format("{} {:.1f} %", verb_, done * 100);
    for (const std::string& part : {left_text(pace_), detail}) {
        if (!part.empty()) line += ", " + part;
    }
    return line;
}

Progress progress_to_stderr(std::string verb) {
    if (stderr_is_terminal()) {
        auto bar = std::make_shared<Bar>(std::move(verb));
        return [bar](double done, const std::string& detail) { bar->show(done, detail); };
    }
    auto log = std::make_shared<ProgressLog>(std::move(verb));
    return [log](double done, const std::string& detail) {
        const std::string line = log->line(done, detail, Clock::now());
        if (!line.empty()) log_line(line);
    };
}

}  // namespace latent::cli
