#include "base/cli.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace latent::cli {
namespace {

// Else a report, or a library's warning, would be written into the file.
TEST(Cli, AFileNeverGetsTheNumberOfAClosedStandardStream) {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        const auto open_after_parsing = [stream] {
            ::close(stream);
            char name[] = "tool";
            char* arguments[] = {name, nullptr};
            CLI::App app{"", "tool"};
            parse(app, 1, arguments);
            ::_exit(::open("/dev/null", O_WRONLY) > STDERR_FILENO && ::write(stream, "", 1) < 0 ? 0 : 1);
        };
        EXPECT_EXIT(open_after_parsing(), ::testing::ExitedWithCode(0), "") << stream;
    }
}

}  // namespace
}  // namespace latent::cli
