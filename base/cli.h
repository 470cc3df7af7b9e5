// base/cli.h: the one grammar of all command lines (README.md, "The tools in five lines"). For what reads arguments, no engine.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "base/progress.h"
#include "base/result.h"

namespace latent::cli {

enum ExitStatus : int {
    kDone = 0,
    kFailed = 1,
    kUsage = 2,
    kDoneWithLosses = 3,  // finished, but something damaged or missing was left out and reported, or the report itself was lost
    kDamaged = 4,         // verify found damage
    kStopped = 75,        // stopped; everything so far is committed: run again to go on
};

// What every tool takes.
struct CommonOptions {
    int threads = 0;                                // 0: as many as the machine has
    std::uint64_t memory = std::uint64_t{1} << 30;  // bytes
    bool json = false;
    bool force = false;
};

// Adds --threads, --json, --force and --version, and --memory where it applies.
void add_common(CLI::App& app, CommonOptions& options, bool with_memory);

// Parses; an exit status if the program should end now: --help and --version 0, misuse 2 (one line on stderr).
// From here on, a program whose standard output cannot be written (disk full, say) says so when it ends, with status kFailed.
std::optional<int> parse(CLI::App& app, int argc, char** argv);

// An option whose text `parse` turns into a Result; what that refuses is misuse.
template <class Value, class Parse>
CLI::Option* add_parsed(CLI::App& app, const std::string& name, Value& value, Parse parse, const std::string& help) {
    const auto take = [&value, parse, name](const std::string& text) {
        auto parsed = parse(text);
        if (!parsed) throw CLI::ValidationError(name, parsed.error().message);
        value = *std::move(parsed);
    };
    return app.add_option_function<std::string>(name, take, help);
}

// An option that takes a size such as 512M, or a time such as 10m.
CLI::Option* add_size(CLI::App& app, const std::string& name, std::uint64_t& value, const std::string& help);
CLI::Option* add_duration(CLI::App& app, const std::string& name, double& seconds, const std::string& help);

// Checks of an argument: the name of a file of the right kind (".latent"); a number that fits 64 bits, where CLI11 would wrap.
CLI::Validator ends_in(const std::string& extension);
CLI::Validator whole_number();

// Writes what was asked for to standard output, without what would steer a terminal. Never fails here: `parse` tells what happens
// if it cannot be written.
void print(const std::string& text);

// Writes the report of outputs that are complete. Returns `status`; if the report cannot be written, says so and returns
// kDoneWithLosses: the outputs stay.
int print_report(const std::string& report, int status);

// Prints "PROGRAM: MESSAGE" on stderr; returns kUsage for ErrorCode::kUsage, kStopped for kStopped, else kFailed.
int fail(const Error& error);

// The program's name for messages ("latent-merge"); set by `parse`.
const std::string& program();

// Print "PROGRAM: warning: MESSAGE" and "PROGRAM: note: MESSAGE" on stderr.
void warn(const std::string& message);
void note(const std::string& message);

}  // namespace latent::cli
