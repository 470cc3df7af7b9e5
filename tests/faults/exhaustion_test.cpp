// Every tool, short of memory or threads at every stage of its work.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <map>

#include "tests/faults/process.h"
#include "tests/support/sanitizers.h"

namespace latent::testing {
namespace {

using Command = std::vector<std::string>;

// How an abort ends a tool: where asserts are on, as what it is.
#ifdef NDEBUG
constexpr int kAborted = 1;
#else
constexpr int kAborted = 128 + SIGABRT;
#endif

class Exhaustion : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        if (kSanitized) return;
        inputs_ = std::make_unique<TemporaryFolder>();
        const Outcome gen = run(
            {tool("latent-inspect"), "gen", "-o", in("a.latent"), "--records", "40000", "--light", "0.2", "--run-samples", "4096"});
        ASSERT_EQ(gen.status, 0) << gen.err;
        const Outcome picture = run({tool("latent-develop"), in("a.latent"), "--size", "200", "-o", in("a.exr")});
        ASSERT_EQ(picture.status, 0) << picture.err;
    }
    static void TearDownTestSuite() { inputs_.reset(); }
    void SetUp() override {
        if (kSanitized) GTEST_SKIP() << "needs the C library's allocator";
    }
    static std::string in(const std::string& name) { return *inputs_ / name; }

    // All tools, with their outputs in the folder `out`.
    static std::vector<Command> commands(const TemporaryFolder& out) {
        const std::string scene = in_tree("scenes/cornell.pbrt");
        const std::string inspect = tool("latent-inspect"), render = tool("latent-render");
        return {{render, "--quiet", scene, "-o", out / "x.latent", "--spp", "1", "--resolution", "64x64", "--threads", "3"},
                {render, "--quiet", scene, "-o", out / "x.latent", "--spp", "1", "--resolution", "32x32", "--integrator", "bdpt"},
                {tool("latent-merge"), in("a.latent"), "-o", out / "m.latent"},
                {tool("latent-merge"), in("a.latent"), "-o", out / "m.latent", "--compact"},
                {tool("latent-develop"), in("a.latent"), "-o", out / "d.exr", "--size", "200", "--memory", "32M", "--mipmap",
                 "--compression", "zip", "--threads", "3"},
                {tool("latent-convert"), in("a.exr"), "-o", out / "c.png", "-o", out / "c.tif", "-o", out / "c.jpg", "-o",
                 out / "c.exr", "-o", out / "c.dzi", "--memory", "64M", "--threads", "3"},
                {tool("latent-print"), in("a.latent"), "-o", out / "p.png", "-o", out / "p.dzi", "--size", "200", "--memory", "64M",
                 "--threads", "3"},
                {inspect, "gen", "-o", out / "g.latent", "--records", "40000", "--run-samples", "4096", "--threads", "3"},
                {inspect, "info", in("a.latent")},
                {inspect, "verify", in("a.latent"), "--deep", "--threads", "3"},
                {inspect, "cat", in("a.latent"), "--limit", "1000"},
                {inspect, "recover", in("a.latent"), "-o", out / "r.latent"}};
    }

    // All files, by name; of records only that they are there: their headers hold the time of day.
    static std::map<std::string, std::string> contents(const TemporaryFolder& folder) {
        std::map<std::string, std::string> out;
        for (const std::filesystem::directory_entry& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
            if (entry.is_regular_file())
                out[std::filesystem::relative(entry.path(), folder.path())] =
                    entry.path().extension() == ".latent" ? "" : read_text(entry.path());
        }
        return out;
    }

    // Done as if nothing had been refused, or one line, status 1, and no more of an output than what a second call goes on from.
    static void check(std::size_t i, const FaultOutcome& outcome, const TemporaryFolder& out) {
        if (outcome.status == 0) {
            EXPECT_EQ(outcome.err, "");
            EXPECT_TRUE(contents(out) == undisturbed(i));
            return;
        }
        if (outcome.err.find("--memory") != std::string::npos) {  // advice names options that the command has
            const Command command = commands(out)[i];
            Command help{command[0]};
            if (command[0] == tool("latent-inspect")) help.push_back(command[1]);
            help.push_back("--help");
            EXPECT_NE(run(help).out.find("--memory"), std::string::npos) << command[0] << ": " << outcome.err;
        }
        const bool library_gave_up = outcome.err.starts_with("Fatal glibc error");
        EXPECT_EQ(outcome.status, library_gave_up ? kAborted : 1) << outcome.err;
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
        EXPECT_TRUE(outcome.err.starts_with("latent-") || library_gave_up) << outcome.err;
        for (const std::string& name : out.names()) {
            EXPECT_TRUE(name.starts_with("x.latent.part.") || name.starts_with("g.latent.part.")) << name;
        }
        if (!out.names().empty()) {
            EXPECT_EQ(run(commands(out)[i]).status, 0);
        }
    }

    static const std::map<std::string, std::string>& undisturbed(std::size_t i) {
        static std::map<std::size_t, std::map<std::string, std::string>> all;
        if (!all.contains(i)) {
            const TemporaryFolder out;
            EXPECT_EQ(run(commands(out)[i]).status, 0);
            all[i] = contents(out);
        }
        return all[i];
    }

    static std::unique_ptr<TemporaryFolder> inputs_;
};
std::unique_ptr<TemporaryFolder> Exhaustion::inputs_;

TEST_F(Exhaustion, WithoutMemoryEveryToolEndsInOneLineAndLeavesNothingHalfDone) {
    const std::size_t tools = commands(TemporaryFolder()).size();
    for (std::size_t i = 0; i < tools; ++i) {
        for (const bool for_good : {false, true}) {
            bool happened = true;
            for (std::uint64_t n = 1; happened; n += 1 + n * 2 / 3) {
                const TemporaryFolder out;
                const Command command = commands(out)[i];
                SCOPED_TRACE(
                    fmt::format("{} {} {} allocation {}{}", command[0], command[1], command.back(), n, for_good ? "+" : ""));
                const FaultOutcome outcome = run_exhausted(command, fmt::format("memory:{}{}", n, for_good ? "+" : ""));
                check(i, outcome, out);
                happened = outcome.happened;
            }
        }
    }
}

TEST_F(Exhaustion, WithoutThreadsToo) {
    const std::size_t tools = commands(TemporaryFolder()).size();
    for (std::size_t i = 0; i < tools; ++i) {
        for (const bool for_good : {false, true}) {
            bool happened = true;
            for (int n = 1; happened; ++n) {
                const TemporaryFolder out;
                const Command command = commands(out)[i];
                SCOPED_TRACE(fmt::format("{} {} {} thread {}{}", command[0], command[1], command.back(), n, for_good ? "+" : ""));
                const FaultOutcome outcome = run_exhausted(command, fmt::format("threads:{}{}", n, for_good ? "+" : ""));
                check(i, outcome, out);
                EXPECT_EQ(outcome.status, outcome.happened ? 1 : 0);
                happened = outcome.happened;
            }
        }
    }
}

// What ulimit -v leaves to the C library, to oneTBB, to Embree and to threads' stacks.
TEST_F(Exhaustion, UnderALimitOfAddressSpaceToo) {
    const std::size_t tools = commands(TemporaryFolder()).size();
    for (std::size_t i = 0; i < tools; ++i) {
        bool failed = false, done = false;
        for (int mebibytes = 40; mebibytes <= 1200; mebibytes += 1 + mebibytes / 4) {
            const TemporaryFolder out;
            Command command = commands(out)[i];
            SCOPED_TRACE(fmt::format("{} {} {} in {} MiB", command[0], command[1], command.back(), mebibytes));
            FaultOutcome outcome;
            Command limited = {"/bin/sh", "-c", fmt::format("ulimit -v {}; exec \"$@\"", mebibytes << 10), "sh"};
            limited.insert(limited.end(), command.begin(), command.end());
            static_cast<Outcome&>(outcome) = run(limited);
            if (outcome.status == 127) continue;  // it cannot even be loaded
            check(i, outcome, out);
            (outcome.status == 0 ? done : failed) = true;
        }
        EXPECT_TRUE(done);
    }
}

}  // namespace
}  // namespace latent::testing
