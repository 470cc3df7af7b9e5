#include "base/temporary_path.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>

#include "tests/faults/process.h"

namespace latent {
namespace {

namespace fs = std::filesystem;

class TemporaryPathTest : public ::testing::Test {
 protected:
    testing::TemporaryFolder folder_;

    void write(const std::string& name) const { std::ofstream(folder_ / name) << "x"; }

    // How a child ends that does `work`, then waits a second.
    static int status_of(const std::function<void()>& work) {
        const pid_t child = ::fork();
        if (child == 0) {
            remove_temporaries_on_signals();
            work();
            ::sleep(1);
            ::_exit(0);
        }
        int status = 0;
        ::waitpid(child, &status, 0);
        return status;
    }
};

TEST_F(TemporaryPathTest, WhatItNamesGoesWithIt) {
    TemporaryPath kept;
    {
        TemporaryPath never(folder_ / "never"), file(folder_ / "file"), folder(folder_ / "folder");
        write("file");
        fs::create_directories(folder.path() / "a/b");
        kept = std::move(file);
        EXPECT_TRUE(file.empty());  // NOLINT: this is what is tested
        EXPECT_EQ(folder_.names(), (std::vector<std::string>{"file", "folder"}));
    }
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"file"});
    kept = {};
    EXPECT_TRUE(folder_.names().empty());
}

TEST_F(TemporaryPathTest, SignalsRemoveItAndEndTheProgramAsTheyWouldHave) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const int status = status_of([&] {
            static const TemporaryPath folder(folder_ / "folder");
            static TemporaryPath renamed(folder_ / "old");
            fs::create_directories(folder.path() / "a/b");
            write("old");
            fs::rename(folder_ / "old", folder_ / "new");
            ::kill(::getpid(), signal);
        });
        EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"new"});
    }
}

TEST_F(TemporaryPathTest, SignalsWaitWhileTheyAreHeld) {
    const int status = status_of([&] {
        const auto held = hold_signals();
        ::kill(::getpid(), SIGTERM);
        ::usleep(200'000);
        write("whole");
    });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM) << status;
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"whole"});
}

TEST_F(TemporaryPathTest, IgnoredSignalsStayIgnored) {
    const auto before = ::signal(SIGHUP, SIG_IGN);  // as nohup does
    const int status = status_of([] { ::kill(::getpid(), SIGHUP); });
    ::signal(SIGHUP, before);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

}  // namespace
}  // namespace latent
