#include "base/cli.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <pthread.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <utility>

#include "base/help.h"
#include "base/near_names.h"
#include "base/output_name.h"
#include "base/parse.h"
#include "base/printable.h"
#include "base/temporary_path.h"
#include "base/url.h"

namespace latent::cli {

namespace {
std::string& program_name() {
    static std::string name = "latent";
    return name;
}

bool failure_was_said = false;

// Names only options that the command has: `parse` sees which.
const char* no_memory_advice = " (try fewer --threads)";

// When memory runs out, several threads may fail at once: the first of them reports it, the others wait for the end.
std::atomic<pthread_t> ending{};

void wait_if_another_ends() {
    while (ending != pthread_t{} && ending != ::pthread_self()) ::pause();
}

// False if this thread is ending already, and failed at that.
bool begin_to_end() {
    pthread_t nobody{};
    const bool first = ending.compare_exchange_strong(nobody, ::pthread_self());
    wait_if_another_ends();
    return first;
}

// Small, so that freeing it makes room for the small allocations of an orderly end.
std::unique_ptr<char[]> reserve;

// Never allocates.
void say_exception(const std::exception_ptr& exception) {
    char line[1024] = "";
    const auto say = [&line](const char* what, const char* advice) {
        std::snprintf(line, sizeof line, "%s: %s%s\n", program_invocation_short_name, what, advice);
    };
    try {
        if (exception) std::rethrow_exception(exception);
        say("failed inside a library", "");
    } catch (const std::bad_alloc&) {
        say("out of memory", no_memory_advice);
    } catch (const std::exception& what) {
        say(what.what(), "");
    } catch (...) {
        say("failed with an unknown exception", "");
    }
    [[maybe_unused]] const ssize_t said = ::write(STDERR_FILENO, line, std::strlen(line));
}

// For std::terminate: no handler catches this exception, or none can be caught where it was thrown.
[[noreturn]] void end_with_exception() {
    if (!begin_to_end()) ::_exit(kFailed);
    reserve.reset();
    say_exception(std::current_exception());
    remove_temporaries();
    ::_exit(kFailed);
}

// For SIGABRT: a library gives up and has said why, as the C library does when a new thread finds no memory for its variables.
// Where asserts are on, an abort is a fault of ours and ends as one.
[[maybe_unused]] void end_with_abort(int) {
    if (!begin_to_end()) ::_exit(kFailed);
    ::alarm(10);  // should its locks be in the way
    remove_temporaries();
    ::_exit(kFailed);
}

// Files that are opened must not be taken for a standard stream that was closed (">&-"): reports would be written into them.
void occupy_closed_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) < 0)
            ::open("/dev/null", O_RDONLY);  // takes the lowest number that is free; writing to it fails
    }
}

// Standard output holds back what is written to it; only when it is flushed does a full disk show.
Status flush_stdout() {
    errno = 0;
    const bool failed_before = std::ferror(stdout) != 0;
    if (std::fflush(stdout) == 0 && !failed_before) return {};
    return errno != 0 ? error_from_errno(errno, "standard output", "cannot write")
                      : Error{ErrorCode::kIo, "standard output: cannot write"};
}

void flush_stdout_at_exit() {
    const Status flushed = flush_stdout();
    if (!flushed && !failure_was_said) ::_exit(fail(flushed.error()));
}

// Options that people know from other programs, and what serves instead.
struct ForeignOption {
    std::string_view name, instead;
};
constexpr ForeignOption kForeignOptions[] = {
    {"--exposure", "prints are exposed by latent-convert --sensitivity, or --stops in EV"},
    {"--ev", "prints are exposed by latent-convert --stops"},
    {"--iso", "prints are exposed by latent-convert --sensitivity"},
    {"--gain", "prints are exposed by latent-convert --sensitivity"},
    {"--gamma", "the curve of a print is latent-convert --tone, with --contrast and --black"},
    {"--temperature", "the white of a print is latent-convert --white 5200K; lamps change with latent-develop --light NAME=5200K"},
    {"--white-balance", "the white of a print is latent-convert --white 5200K"},
    {"--denoise", "noise is removed by latent-develop --denoise"},
    {"--denoiser", "noise is removed by latent-develop --denoise"},
    {"--width", "the size in pixels is latent-develop --size, or latent-render --resolution"},
    {"--height", "the size in pixels is latent-develop --size, or latent-render --resolution"},
    {"--res", "the size in pixels is latent-develop --size, or latent-render --resolution"},
    {"--samples-per-pixel", "that is latent-render --spp"},
    {"--aperture", "the lens is stopped down by latent-develop --aperture; the glare of lamps is latent-convert --glare f:8"},
    {"--f-number", "that is latent-develop --aperture f:8; for the glare of lamps, latent-convert --glare f:8"},
    {"--f-stop", "that is latent-develop --aperture f:8; for the glare of lamps, latent-convert --glare f:8"},
    {"--fnumber", "that is latent-develop --aperture f:8; for the glare of lamps, latent-convert --glare f:8"},
    {"--fstop", "that is latent-develop --aperture f:8; for the glare of lamps, latent-convert --glare f:8"},
    {"--blades", "that is latent-develop --aperture blades:6; for the glare of lamps, latent-convert --glare blades:6"},
    {"--bloom", "that is latent-convert --glare"},
    {"--glare", "glare belongs to prints: latent-convert --glare"},
    {"--stereo", "a stereo pair is latent-develop --aperture left, and --aperture right"},
    {"--apodise", "soft openings are latent-develop --aperture gaussian"},
    {"--anamorphic", "that is latent-develop --aperture anamorphic:1.33"},
    {"--cat-eye", "that is latent-develop --aperture cat-eye:0.5"},
    {"--rolling", "that is latent-develop --shutter rolling:0.5"},
    {"--shutter-curve", "that is latent-develop --shutter soft, film, or a CSV file"},
};

// Where a command is needed, and the first argument is none.
std::string missing_command(const CLI::App& app, const std::vector<std::string>& unknown) {
    std::vector<std::string> names;
    std::string list;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
        list += (list.empty() ? "" : ", ") + names.back();
    }
    if (unknown.empty()) return "a command is missing: " + list;
    std::error_code ignored;
    const std::filesystem::path path(unknown.front());
    if (is_url(unknown.front()) || path.has_extension() || std::filesystem::exists(path, ignored))
        return fmt::format("a command is missing; try: {} {} {}", program(), names.front(), unknown.front());
    const std::string near = near_names(unknown.front(), names);
    return fmt::format("unknown command {}; {}", unknown.front(),
                       near.empty() ? "choose from " + list : fmt::format("did you mean {}?", near));
}

// What to say about an unknown argument: "unknown argument --preveiw (did you mean --preview?)".
std::string unknown_argument(const CLI::App& app, const std::string& argument) {
    std::vector<std::string> names;
    const auto add_names = [&names](const CLI::App* command) {
        for (const CLI::Option* option : command->get_options()) {
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        }
    };
    add_names(&app);
    for (const CLI::App* command : app.get_subcommands([](const CLI::App* c) { return c->parsed() || c->get_name().empty(); }))
        add_names(command);
    const std::string option = argument.substr(0, argument.find('='));
    const auto foreign = std::ranges::find(kForeignOptions, std::string_view(option), &ForeignOption::name);
    if (foreign != std::end(kForeignOptions)) return fmt::format("unknown argument {}: {}", argument, foreign->instead);
    const std::string near = argument.starts_with("-") ? near_names(option, names) : "";
    return fmt::format("unknown argument {}{}", argument, near.empty() ? "" : fmt::format(" (did you mean {}?)", near));
}

template <class Value>
CLI::Option* add_real(CLI::App& app, const std::string& name, Value& value, const std::string& help, double least, double most,
                      const std::string& range) {
    const auto parse = [least, most, range](const std::string& text) -> Result<double> {
        const Result<double> number = parse_number(text);
        if (number && *number >= least && *number <= most) return number;
        return is_not(text, number ? range : "a number");
    };
    const std::optional<double> before = value;
    return add_parsed(app, name, value, parse, help)->type_name("X")->default_str(before ? fmt::format("{}", *before) : "");
}

template <class Value>
CLI::Option* add_within(CLI::App& app, const std::string& name, Value& value, const std::string& help, double least, double most) {
    return add_real(app, name, value, help, least, most, fmt::format("from {} to {}", least, most));
}

template <class Value>
CLI::Option* add_positive(CLI::App& app, const std::string& name, Value& value, const std::string& help) {
    return add_real(app, name, value, help, 1e-150, 1e150, "a number above 0");
}
}  // namespace

// CLI11 says "--output: 1 required TEXT:NAME.latent missing" and "--output: At Most 1 required but received 2".
std::string in_plain_words(const CLI::ParseError& error) {
    const std::string what = error.what();
    // "--gamut: foo not in {luminance,grey,clip}"
    if (const std::size_t colon = what.find(": "), choices = what.find(" not in {"); choices != what.npos && colon < choices) {
        std::string list = what.substr(choices + 9, what.size() - choices - 10);
        for (std::size_t at = 0; (at = list.find(',', at)) != list.npos; at += 2) list.replace(at, 1, ", ");
        return fmt::format("{}: unknown choice '{}'; choose from {}", what.substr(0, colon),
                           what.substr(colon + 2, choices - colon - 2), list);
    }
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) == nullptr) return what;
    return what.substr(0, what.find(": ")) + (what.ends_with("missing") ? ": a value is missing" : ": given more than once");
}

const std::string& program() { return program_name(); }

void add_common(CLI::App& app, CommonOptions& options, bool with_memory) {
    add_count(app, "--threads", options.threads, "maximum number of worker threads; 0: one per CPU", 0, 4096);
    if (with_memory) add_memory(app, options.memory, "memory limit");
    app.add_flag("--json", options.json, "print the report as JSON on standard output");
    app.add_flag("--force", options.force, "replace an existing output");
    app.add_flag("-q,--quiet", options.quiet, "print no progress: neither the bar on a terminal nor the lines in a log");
    app.set_version_flag("--version", app.get_name() + " " LATENT_VERSION, "print the version");
    app.set_help_flag("-h,--help", "print this help");
}

Progress progress(const CommonOptions& options, std::string verb) {
    return options.quiet ? Progress() : progress_to_stderr(std::move(verb));
}

std::optional<int> parse(CLI::App& app, int argc, char** argv) {
    std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit of its size is told of like a full disk
    program_name() = app.get_name();
    occupy_closed_streams();
    std::atexit(flush_stdout_at_exit);
    std::set_terminate(end_with_exception);
    reserve = std::make_unique_for_overwrite<char[]>(
        8 << 20);  // enough for what follows: a global_control that finds no memory waits for ever
    reserve.reset();
    // Else oneTBB would go on waiting for tasks that were lost for want of memory.
    static const tbb::global_control ends_too(tbb::global_control::terminate_on_exception, 1);
    reserve = std::make_unique<char[]>(64 << 10);
#ifdef NDEBUG
    std::signal(SIGABRT, end_with_abort);
#endif
    format_help(app);
    try {
        app.parse(argc, argv);
        const auto takes_memory = [](const CLI::App* command) { return command->get_option_no_throw("--memory") != nullptr; };
        if (takes_memory(&app) || std::ranges::any_of(app.get_subcommands(), takes_memory))
            no_memory_advice = " (try fewer --threads, or a smaller --memory)";
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        // What is missing may be there, but misspelt: so what was not understood comes first.
        std::vector<std::string> unknown = app.remaining(true);
        std::erase(unknown, "--");
        const auto is = [&error](CLI::ExitCodes code) { return error.get_exit_code() == static_cast<int>(code); };
        const bool misspelt = (is(CLI::ExitCodes::RequiredError) || is(CLI::ExitCodes::ExtrasError)) && !unknown.empty();
        const bool commandless = app.get_require_subcommand_min() > 0 && app.get_subcommands().empty() &&
                                 (unknown.empty() || !unknown.front().starts_with("-"));
        const std::string what = commandless && (misspelt || is(CLI::ExitCodes::RequiredError)) ? missing_command(app, unknown)
                                 : misspelt ? unknown_argument(app, unknown.front())
                                            : in_plain_words(error);
        fmt::print(stderr, "{}: {}; see --help\n", program(), printable(what));
        return kUsage;
    }
}

void add_list(CLI::App& app, const std::string& name, std::string (*list)(), const std::string& help) {
    const auto show = [list] {
        print(list());
        throw CLI::Success();
    };
    app.add_flag_callback(name, show, help);
}

CLI::Validator ends_in(const std::string& extension, const std::string& otherwise) {
    const auto check = [extension, otherwise](const std::string& name) -> std::string {
        if (std::filesystem::path(name).extension() == extension) return {};
        if (const std::string problem = objection_to_output(name); !problem.empty()) return problem;
        return fmt::format("{}: the name must end in {}{}", shown_name(name), extension, otherwise);
    };
    return CLI::Validator(check, "NAME" + extension);
}

CLI::Validator not_empty() {
    return {[](const std::string& name) { return std::string(name.empty() ? "a name is missing" : ""); }, ""};
}

Result<std::uint64_t> parse_count_within(std::string_view text, std::uint64_t least, std::uint64_t most) {
    const Result<std::uint64_t> count = parse_count(text);
    if (count && (*count < least || *count > most))
        return usage_error(fmt::format("'{}' is not between {} and {}", text, least, most));
    return count;
}

CLI::Option* add_number(CLI::App& app, const std::string& name, double& value, const std::string& help, double least, double most) {
    return add_within(app, name, value, help, least, most);
}
CLI::Option* add_number(CLI::App& app, const std::string& name, std::optional<double>& value, const std::string& help, double least,
                        double most) {
    return add_within(app, name, value, help, least, most);
}
CLI::Option* add_positive_number(CLI::App& app, const std::string& name, double& value, const std::string& help) {
    return add_positive(app, name, value, help);
}
CLI::Option* add_positive_number(CLI::App& app, const std::string& name, std::optional<double>& value, const std::string& help) {
    return add_positive(app, name, value, help);
}

CLI::Option* add_size(CLI::App& app, const std::string& name, std::uint64_t& value, const std::string& help) {
    return add_parsed(app, name, value, parse_size, help)->type_name("SIZE");
}

CLI::Option* add_memory(CLI::App& app, std::uint64_t& value, const std::string& help) {
    return add_size(app, "--memory", value, help + "; the default is at most half of what the machine or container allows")
        ->default_str("1G");
}

CLI::Option* add_duration(CLI::App& app, const std::string& name, double& seconds, const std::string& help) {
    return add_parsed(app, name, seconds, parse_duration, help)->type_name("TIME");
}

void print(const std::string& text) {
    constexpr std::size_t kAtOnce = 1 << 16;
    const std::string_view all(text);
    for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
        end = std::min(begin + kAtOnce, all.size());
        while (end < all.size() && (all[end] & 0xc0) == 0x80) ++end;  // inside a character
        const std::string shown = printable(all.substr(begin, end - begin));
        std::fwrite(shown.data(), 1, shown.size(), stdout);
    }
}

int print_report(const std::string& report, int status) {
    std::signal(SIGPIPE, SIG_IGN);  // a reader who went away is told of like a full disk
    print(report);
    const Status flushed = flush_stdout();
    if (flushed) return status;
    failure_was_said = true;
    warn(flushed.error().message + "; only the report is lost, the output is kept");
    return kDoneWithLosses;
}

int fail(const Error& error) {
    wait_if_another_ends();
    failure_was_said = true;
    fmt::print(stderr, "{}: {}{}\n", program(), printable(error.message),
               error.code == ErrorCode::kNoMemory ? no_memory_advice : "");
    if (error.code == ErrorCode::kUsage) return kUsage;
    return error.code == ErrorCode::kStopped ? kStopped : kFailed;
}

int fail_with_exception() {
    begin_to_end();
    reserve.reset();
    failure_was_said = true;
    say_exception(std::current_exception());
    return kFailed;
}

void warn(const std::string& message) { fmt::print(stderr, "{}: warning: {}\n", program(), printable(message)); }
void note(const std::string& message) { fmt::print(stderr, "{}: note: {}\n", program(), printable(message)); }

void tell(const std::vector<std::string>& notes, const std::vector<std::string>& warnings, const std::vector<std::string>& losses) {
    std::ranges::for_each(notes, note);
    std::ranges::for_each(warnings, warn);
    std::ranges::for_each(losses, warn);
}

}  // namespace latent::cli
