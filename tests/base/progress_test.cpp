#include "base/progress.h"

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>
#include <vector>

#include "base/cli.h"

namespace latent::cli {
namespace {

using std::chrono::seconds;

TEST(Progress, ALineNeverExceedsItsColumnsAndKeepsWhatMattersMost) {
    const std::string left = "1h02m left", detail = "1.234 M samples/s, 3.4 GiB";
    std::size_t before = 0;
    for (std::size_t columns = 0; columns <= 200; ++columns) {
        const std::string line = progress_line("rendering", 0.375, left, detail, columns);
        EXPECT_LE(line.size(), columns);
        EXPECT_EQ(line.find("38%") != std::string::npos, columns >= 4) << line;
        EXPECT_TRUE(line.find(detail) == std::string::npos || line.find(left) != std::string::npos) << line;
        EXPECT_GE(line.size(), before);  // more room is used, or left alone
        before = line.size();
    }
    EXPECT_EQ(progress_line("rendering", 0.375, left, detail, 200),
              "rendering [#########...............]   38%  1h02m left  1.234 M samples/s, 3.4 GiB");
    EXPECT_EQ(progress_line("rendering", 0.375, left, detail, 38), "rendering [###.....]   38%  1h02m left");
    EXPECT_EQ(progress_line("rendering", 0.375, left, detail, 20), "rendering  38%");
}

TEST(Progress, APartBeyondAllOfItFillsTheBar) {
    EXPECT_EQ(progress_line("x", 1.5, "", "", 18), "x [########]  100%");
    EXPECT_EQ(progress_line("x", -1, "", "", 19), "x [.........]    0%");
}

TEST(Progress, ThePaceIsThatOfThisRunAlone) {
    Pace pace;
    const Pace::Clock::time_point begin{};
    pace.add(0.9, begin);  // done before
    EXPECT_FALSE(pace.seconds_left());
    pace.add(0.9, begin + seconds(5));
    EXPECT_FALSE(pace.seconds_left());
    pace.add(0.92, begin + seconds(10));
    ASSERT_TRUE(pace.seconds_left());
    EXPECT_NEAR(*pace.seconds_left(), 40, 1e-9);  // 0.08 at 0.002 per second
    pace.add(1, begin + seconds(20));
    EXPECT_EQ(*pace.seconds_left(), 0);
}

TEST(Progress, ALogGetsALineEveryHalfMinute) {
    ProgressLog log("merging");
    const Pace::Clock::time_point begin{};
    int lines = 0;
    for (int second = 0; second <= 100; ++second) {
        const std::string line = log.line(0.5 + second / 1024.0, "3.4 GiB", begin + seconds(second));
        EXPECT_EQ(!line.empty(), second > 0 && second % 30 == 0) << second;
        lines += line.empty() ? 0 : 1;
        if (second == 60) {
            EXPECT_EQ(line, "merging 55.9 %, 7m32s left, 3.4 GiB");  // 452 of 1024 seconds
        }
    }
    EXPECT_EQ(lines, 3);
}

TEST(Progress, QuietIsQuiet) {
    CommonOptions options;
    EXPECT_TRUE(progress(options, "merging"));
    options.quiet = true;
    EXPECT_FALSE(progress(options, "merging"));
}

// Standard error is a terminal while this lives.
class Terminal {
 public:
    Terminal() : before_(::dup(STDERR_FILENO)) {
        int slave = -1;
        if (::openpty(&master_, &slave, nullptr, nullptr, nullptr) != 0) return;
        ::dup2(slave, STDERR_FILENO);
        ::close(slave);
        reader_ = std::thread([this] {
            char buffer[4096];
            for (ssize_t got = 0; (got = ::read(master_, buffer, sizeof buffer)) > 0;)
                text_.append(buffer, static_cast<std::size_t>(got));
        });
    }
    bool opened() const { return reader_.joinable(); }
    static void resize(unsigned short columns) {
        const struct winsize size { 24, columns, 0, 0 };
        ::ioctl(STDERR_FILENO, TIOCSWINSZ, &size);
    }
    // All that was written to it. It ends with that.
    std::string close() {
        ::dup2(before_, STDERR_FILENO);
        ::close(before_);
        reader_.join();
        ::close(master_);
        return text_;
    }

 private:
    int before_, master_ = -1;
    std::thread reader_;
    std::string text_;
};

TEST(Progress, TheBarStaysInItsRowWhileTheTerminalGetsAnyWidth) {
    std::vector<std::size_t> widths;
    for (std::size_t columns = 120; columns > 0; --columns) widths.push_back(columns);
    for (std::size_t columns = 1; columns <= 120; columns += 7) widths.push_back(columns);
    ::setenv("TERM", "xterm", 1);
    Terminal terminal;
    ASSERT_TRUE(terminal.opened());
    {
        const Progress bar = progress_to_stderr("rendering");
        for (const std::size_t columns : widths) {
            Terminal::resize(static_cast<unsigned short>(columns));
            bar(1, "1.234 M samples/s, 3.4 GiB written");
        }
    }
    std::string text = terminal.close();
    EXPECT_EQ(text.find('\n'), text.npos);
    const std::string begin = "\r\033[K";
    std::vector<std::string> rows;
    for (std::size_t at = text.find(begin); at != text.npos;) {
        const std::size_t next = text.find(begin, at + begin.size());
        rows.push_back(text.substr(at + begin.size(), next - at - begin.size()));
        at = next;
    }
    ASSERT_EQ(rows.size(), widths.size() + 1);
    for (std::size_t i = 0; i < widths.size(); ++i) {
        EXPECT_LT(rows[i].size(), widths[i]);
        EXPECT_EQ(rows[i].find("100%") != std::string::npos, widths[i] > 4) << rows[i];
    }
    EXPECT_EQ(rows.back(), "");
}

}  // namespace
}  // namespace latent::cli
