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

// CLI11 says "--gamut: foo not in {luminance,grey}".
TEST(Cli, AnUnknownChoiceNamesThoseThereAre) {
    const auto parse_foo = [] {
        int gamut = 0;
        char name[] = "tool", option[] = "--gamut", value[] = "foo";
        char* arguments[] = {name, option, value, nullptr};
        CLI::App app{"", "tool"};
        add_choice<int>(app, "--gamut", gamut, {{"luminance", 0}, {"grey", 1}}, "");
        ::_exit(parse(app, 3, arguments).value_or(0));
    };
    EXPECT_EXIT(parse_foo(), ::testing::ExitedWithCode(kUsage),
                "^tool: --gamut: unknown choice 'foo'; choose from luminance, grey; see --help\n$");
}

TEST(Cli, AnOptionOfOtherProgramsNamesWhatServesHere) {
    const auto parse_with = [](std::string option) {
        char name[] = "tool";
        char* arguments[] = {name, option.data(), nullptr};
        CLI::App app{"", "tool"};
        ::_exit(parse(app, 2, arguments).value_or(0));
    };
    EXPECT_EXIT(parse_with("--exposure"), ::testing::ExitedWithCode(kUsage),
                "^tool: unknown argument --exposure: [^\n]*--sensitivity[^\n]*; see --help\n$");
    EXPECT_EXIT(parse_with("--denoise"), ::testing::ExitedWithCode(kUsage),
                "^tool: unknown argument --denoise: noise is removed by latent-develop --denoise[^\n]*; see --help\n$");
    EXPECT_EXIT(parse_with("--temperature=5000"), ::testing::ExitedWithCode(kUsage), "--white 5200K[^\n]*; see --help\n$");
}

TEST(Cli, WithoutACommandTheFileGetsOne) {
    const auto parse_with = [](std::vector<std::string> words) {
        words.insert(words.begin(), "tool");
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        CLI::App app{"", "tool"};
        app.require_subcommand(1);
        for (const char* command : {"info", "verify"}) app.add_subcommand(command, "");
        ::_exit(parse(app, static_cast<int>(arguments.size()), arguments.data()).value_or(0));
    };
    EXPECT_EXIT(parse_with({}), ::testing::ExitedWithCode(kUsage), "^tool: a command is missing: info, verify; see --help\n$");
    EXPECT_EXIT(parse_with({"/dev/null"}), ::testing::ExitedWithCode(kUsage),
                "^tool: a command is missing; try: tool info /dev/null; see --help\n$");
    EXPECT_EXIT(parse_with({"no.latent"}), ::testing::ExitedWithCode(kUsage),
                "^tool: a command is missing; try: tool info no.latent; see --help\n$");
    EXPECT_EXIT(parse_with({"verfy"}), ::testing::ExitedWithCode(kUsage),
                "^tool: unknown command verfy; did you mean verify\\?; see --help\n$");
    EXPECT_EXIT(parse_with({"zzz"}), ::testing::ExitedWithCode(kUsage),
                "^tool: unknown command zzz; choose from info, verify; see --help\n$");
}

TEST(Cli, AMisspeltOptionIsTheFirstThingSaidWithThoseThatAreNear) {
    const auto parse_with = [](std::string option) {
        double seconds = 0;
        std::string scene;
        char name[] = "tool", value[] = "3s";
        char* arguments[] = {name, option.data(), value, nullptr};
        CLI::App app{"", "tool"};
        app.add_option("SCENE", scene)->required(option == "--preveiw");
        add_duration(app, "--preview", seconds, "");
        ::_exit(parse(app, 3, arguments).value_or(0));
    };
    EXPECT_EXIT(parse_with("--preveiw"), ::testing::ExitedWithCode(kUsage),
                "^tool: unknown argument --preveiw \\(did you mean --preview\\?\\); see --help\n$");
    EXPECT_EXIT(parse_with("--previews=2s"), ::testing::ExitedWithCode(kUsage),
                "^tool: unknown argument --previews=2s \\(did you mean --preview\\?\\); see --help\n$");
    EXPECT_EXIT(parse_with("--zzz"), ::testing::ExitedWithCode(kUsage), "^tool: unknown argument --zzz; see --help\n$");
}

}  // namespace
}  // namespace latent::cli
