// base/cli.h: the one grammar of all command lines (README.md, "The tools in five lines"). For what reads arguments, no engine.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "base/parse.h"
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
    int threads = 0;                          // 0: as many as the machine has
    std::uint64_t memory = default_memory();  // bytes
    bool json = false;
    bool force = false;
    bool quiet = false;
};

// Adds --threads, --json, --force, --quiet and --version, and --memory where it applies.
void add_common(CLI::App& app, CommonOptions& options, bool with_memory);

// For an engine: `progress_to_stderr`, or nothing if --quiet was given.
Progress progress(const CommonOptions& options, std::string verb);

// Parses; an exit status if the program should end now: --help and --version 0, misuse 2 (one line on stderr).
// From here on, a program whose standard output cannot be written (disk full, say) says so when it ends, with status kFailed.
std::optional<int> parse(CLI::App& app, int argc, char** argv);

// An option whose text `parse` turns into a Result; what that refuses is misuse.
template <class Value, class Parse>
CLI::Option* add_parsed(CLI::App& app, const std::string& name, Value& value, Parse parse, const std::string& help) {
    const auto take = [&value, parse, name](const std::string& text) {
        auto parsed = parse(text);
        if (!parsed) throw CLI::ValidationError(name.substr(name.find(',') + 1), parsed.error().message);
        value = static_cast<Value>(*std::move(parsed));
    };
    return app.add_option_function<std::string>(name, take, help);
}

// --crop: pixels of a rectangle, whose members are x0, y0, x1, y1.
template <class Rect>
void add_crop(CLI::App& app, std::optional<Rect>& crop, const std::string& help) {
    const auto parse = [](const std::string& text) {
        return parse_crop(text).map([](const auto& c) { return Rect{c[0], c[1], c[2], c[3]}; });
    };
    add_parsed(app, "--crop", crop, parse, help)->type_name("X0,Y0,X1,Y1");
}

// Options of one grammar, base/parse.h: a count within bounds, a real number within bounds, bytes ("512M"), seconds ("10m").
// --help shows the bounds, if there are any, and the value before parsing, if it lies within them.
template <std::integral Integer>
CLI::Option* add_count(CLI::App& app, const std::string& name, Integer& value, const std::string& help, Integer least = 0,
                       Integer most = std::numeric_limits<Integer>::max());
CLI::Option* add_number(CLI::App& app, const std::string& name, double& value, const std::string& help, double least, double most);
CLI::Option* add_number(CLI::App& app, const std::string& name, std::optional<double>& value, const std::string& help, double least,
                        double most);
CLI::Option* add_positive_number(CLI::App& app, const std::string& name, double& value, const std::string& help);  // 1e-150..1e150
CLI::Option* add_positive_number(CLI::App& app, const std::string& name, std::optional<double>& value, const std::string& help);
CLI::Option* add_size(CLI::App& app, const std::string& name, std::uint64_t& value, const std::string& help);
CLI::Option* add_memory(CLI::App& app, std::uint64_t& value, const std::string& help);  // --memory, of base/memory.h's default
CLI::Option* add_duration(CLI::App& app, const std::string& name, double& seconds, const std::string& help);

// An option that takes one of a few words, each standing for a value. --help shows the word of the value before parsing.
template <class Value>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Value& value,
                        const std::vector<std::pair<std::string, Value>>& choices, const std::string& help);

// A flag that prints what `list` returns instead of doing anything.
void add_list(CLI::App& app, const std::string& name, std::string (*list)(), const std::string& help);

// A check of an argument: the name of a file of the right kind (".latent"). `otherwise`: what follows if it is not ("; ...").
CLI::Validator ends_in(const std::string& extension, const std::string& otherwise = "");

// For names that mean something else if none is given: an empty one, of an unset variable of the shell, say, is misuse.
CLI::Validator not_empty();

// Writes what was asked for to standard output, without what would steer a terminal. Never fails here: `parse` tells what happens
// if it cannot be written.
void print(const std::string& text);

// Writes the report of outputs that are complete. Returns `status`; if the report cannot be written, says so and returns
// kDoneWithLosses: the outputs stay.
int print_report(const std::string& report, int status);

// What CLI11 says of a misuse, as `parse` says it.
std::string in_plain_words(const CLI::ParseError& error);

// Prints "PROGRAM: MESSAGE" on stderr; returns kUsage for ErrorCode::kUsage, kStopped for kStopped, else kFailed.
int fail(const Error& error);

// For the `catch (...)` of main: prints the exception as `fail` would, without memory if there is none left; returns kFailed.
// `parse` sees to it that exceptions in any other thread end the program in the same way, after removing what is temporary.
int fail_with_exception();

// The program's name for messages ("latent-merge"); set by `parse`.
const std::string& program();

// Print "PROGRAM: warning: MESSAGE" and "PROGRAM: note: MESSAGE" on stderr.
void warn(const std::string& message);
void note(const std::string& message);

// What a report has to say before it: notes, warnings, and what was lost.
void tell(const std::vector<std::string>& notes, const std::vector<std::string>& warnings, const std::vector<std::string>& losses);

// What add_count makes: the text of a count that is within the bounds.
Result<std::uint64_t> parse_count_within(std::string_view text, std::uint64_t least, std::uint64_t most);

template <std::integral Integer>
CLI::Option* add_count(CLI::App& app, const std::string& name, Integer& value, const std::string& help, Integer least,
                       Integer most) {
    const auto parse = [least, most](const std::string& text) {
        return parse_count_within(text, static_cast<std::uint64_t>(least), static_cast<std::uint64_t>(most));
    };
    const bool bounded = most != std::numeric_limits<Integer>::max();
    const bool shown = least <= value && value <= most && (bounded || value != most);
    return add_parsed(app, name, value, parse, help)
        ->type_name(bounded ? std::to_string(least) + ".." + std::to_string(most) : "N")
        ->default_str(shown ? std::to_string(value) : "");
}

template <class Value>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Value& value,
                        const std::vector<std::pair<std::string, Value>>& choices, const std::string& help) {
    std::vector<std::string> words;
    std::string before;
    for (const auto& [word, meaning] : choices) {
        words.push_back(word);
        if (meaning == value) before = word;
    }
    const auto take = [&value, choices](const std::string& word) {
        value = std::ranges::find(choices, word, &std::pair<std::string, Value>::first)->second;
    };
    return app.add_option_function<std::string>(name, take, help)->check(CLI::IsMember(words))->default_str(before);
}

}  // namespace latent::cli
