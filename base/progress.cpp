#include "base/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <memory>

#include "base/size.h"

namespace latent::cli {

namespace {

class Bar {
 public:
    explicit Bar(std::string verb) : verb_(std::move(verb)), begin_(Clock::now()) {}
    ~Bar() {
        if (drawn_) fmt::print(stderr, "\r\033[K");
    }
    void show(double done, const std::string& detail) {
        const Clock::time_point now = Clock::now();
        if (drawn_ && done < 1 && now - last_ < std::chrono::milliseconds(100)) return;
        last_ = now;
        drawn_ = true;
        const double elapsed = std::chrono::duration<double>(now - begin_).count();
        const std::string left = done > 0.001 ? format_duration(elapsed * (1 - done) / done) + " left" : "";
        constexpr int kWidth = 24;
        const int filled = static_cast<int>(done * kWidth);
        fmt::print(stderr, "\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f}%  {}  {}", verb_, "", filled, "", kWidth - filled, done * 100, left,
                   detail);
        std::fflush(stderr);
    }

 private:
    using Clock = std::chrono::steady_clock;
    std::string verb_;
    Clock::time_point begin_, last_;
    bool drawn_ = false;
};

}  // namespace

Progress progress_to_stderr(std::string verb) {
    if (!::isatty(STDERR_FILENO)) return {};
    auto bar = std::make_shared<Bar>(std::move(verb));
    return [bar](double done, const std::string& detail) { bar->show(done, detail); };
}

}  // namespace latent::cli
