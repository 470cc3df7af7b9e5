#include "base/cli.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>

#include "base/help.h"
#include "base/printable.h"
#include "base/size.h"

namespace latent::cli {

namespace {
std::string& program_name() {
    static std::string name = "latent";
    return name;
}

bool failure_was_said = false;

// Standard output holds back what is written to it; only when it is flushed does a full disk show.
void flush_stdout_at_exit() {
    errno = 0;
    const bool failed_before = std::ferror(stdout) != 0;
    if ((std::fflush(stdout) == 0 && !failed_before) || failure_was_said) return;
    const Error error = errno != 0 ? error_from_errno(errno, "standard output", "cannot write")
                                   : Error{ErrorCode::kIo, "standard output: cannot write"};
    ::_exit(fail(error));
}
}  // namespace

const std::string& program() { return program_name(); }

void add_common(CLI::App& app, CommonOptions& options, bool with_memory, bool with_force) {
    app.add_option("--threads", options.threads, "at most so many worker threads; 0: one for each processor")
        ->check(CLI::Range(0, 4096))
        ->capture_default_str();
    if (with_memory) add_size(app, "--memory", options.memory, "memory to stay within (K, M, G are binary)")->default_str("1G");
    app.add_flag("--json", options.json, "print the report as JSON on stdout");
    if (with_force) app.add_flag("--force", options.force, "replace an output that exists");
    app.set_version_flag("--version", std::string(LATENT_VERSION), "print the version");
}

std::optional<int> parse(CLI::App& app, int argc, char** argv) {
    program_name() = app.get_name();
    std::atexit(flush_stdout_at_exit);
    const auto formatter = std::make_shared<HelpFormatter>();
    app.formatter(formatter);
    for (CLI::App* command : app.get_subcommands({})) command->formatter(formatter);
    try {
        app.parse(argc, argv);
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        // What is missing may be there, but misspelt: so what was not understood comes first.
        const std::vector<std::string> unknown = app.remaining(true);
        const bool misspelt = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError) && !unknown.empty();
        const std::string what = misspelt ? unknown.front() + " was not understood" : error.what();
        fmt::print(stderr, "{}: {} (--help explains)\n", program(), printable(what));
        return kUsage;
    }
}

CLI::Validator ends_in(const std::string& extension) {
    const auto check = [extension](const std::string& name) {
        return name.ends_with(extension) ? std::string() : fmt::format("{}: the name must end in {}", name, extension);
    };
    return CLI::Validator(check, "NAME" + extension);
}

CLI::Validator whole_number() {
    const auto check = [](const std::string& text) {
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool good = error == std::errc() && end == text.data() + text.size();
        return good ? std::string() : fmt::format("{}: should be a whole number from 0 to {}", text, ~std::uint64_t{0});
    };
    return CLI::Validator(check, "N");
}

CLI::Option* add_size(CLI::App& app, const std::string& name, std::uint64_t& value, const std::string& help) {
    return app
        .add_option_function<std::string>(
            name,
            [&value, name](const std::string& text) {
                const Result<std::uint64_t> size = parse_size(text);
                if (!size) throw CLI::ValidationError(name, size.error().message);
                value = *size;
            },
            help)
        ->type_name("SIZE");
}

CLI::Option* add_duration(CLI::App& app, const std::string& name, double& seconds, const std::string& help) {
    return app
        .add_option_function<std::string>(
            name,
            [&seconds, name](const std::string& text) {
                const Result<double> duration = parse_duration(text);
                if (!duration) throw CLI::ValidationError(name, duration.error().message);
                seconds = *duration;
            },
            help)
        ->type_name("TIME");
}

int fail(const Error& error) {
    failure_was_said = true;
    fmt::print(stderr, "{}: {}\n", program(), printable(error.message));
    if (error.code == ErrorCode::kUsage) return kUsage;
    return error.code == ErrorCode::kStopped ? kStopped : kFailed;
}

void warn(const std::string& message) { fmt::print(stderr, "{}: warning: {}\n", program(), printable(message)); }

}  // namespace latent::cli
