#include "base/help.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace latent::cli {

namespace {
// Whose options are those of the app itself.
bool is_section(const CLI::App* app) { return app->get_name().empty(); }

// What stands for the value: a name of our own ("SIZE", "A:B"), or what CLI11 makes of the type and its check: "TEXT",
// "TEXT:{both,camera,light}", "TEXT:NAME.latent".
std::string placeholder(const std::string& type) {
    if (!type.starts_with("TEXT:")) return type;
    std::string check = type.substr(type.find(':') + 1);
    if (!check.starts_with('{')) return check;
    std::ranges::replace(check, ',', '|');
    return check.substr(1, check.find('}') - 1);
}

constexpr std::size_t kHelpWidth = 80, kHelpIndent = 31;  // widths of all help, and the column where descriptions of options begin

// `text` in lines of at most `width` characters, broken at spaces.
std::string wrapped(const std::string& text, std::size_t width) {
    std::string out;
    std::size_t begin = 0;
    while (text.size() - begin > width) {
        const std::size_t space = text.rfind(' ', begin + width);
        if (space == std::string::npos || space <= begin) break;
        out += text.substr(begin, space - begin) + "\n";
        begin = space + 1;
    }
    return out + text.substr(begin);
}

// What holds for several options: how values are written, where a command inherits options from its tool.
std::string notes_on_options(const CLI::App& app) {
    bool numbers = false, sizes = false, times = false;
    const auto look_at = [&](const CLI::App& some) {
        for (const CLI::Option* option : some.get_options()) {
            const std::string type = option->get_type_name();
            numbers |= type == "N" || type == "X" || type.find("..") != std::string::npos;
            sizes |= type == "SIZE";
            times |= type == "TIME";
        }
    };
    look_at(app);
    for (const CLI::App* section : app.get_subcommands(is_section)) look_at(*section);
    std::string text;
    if (numbers) text += "Numbers accept K, M, G, T (powers of 1000) and Ki, Mi, Gi, Ti (powers of 1024).\n";
    if (sizes) text += "SIZE is in bytes, where K, M, G, T are powers of 1024.\n";
    if (times) text += "TIME is in seconds, or like 90s, 10m, 1.5h or 1h30m.\n";
    if (const CLI::App* tool = app.get_parent()) text += "General options: see " + tool->get_name() + " --help.\n";
    return text.empty() ? text : text + "\n";
}

class HelpFormatter final : public CLI::Formatter {
 public:
    HelpFormatter() {
        column_width(kHelpIndent);
        label("Positionals", "Arguments");
        label("SUBCOMMAND", "COMMAND");
    }

    // Options of sections (base/recipe_options.h) follow the others. No tool has both sections and commands.
    std::string make_subcommands(const CLI::App* app, CLI::AppFormatMode mode) const override {
        std::string text;
        std::set<std::string> names;
        for (const CLI::App* section : app->get_subcommands(is_section)) {
            std::vector<const CLI::Option*> options;
            for (const CLI::Option* option : section->get_options()) {
                if (names.insert(option->get_name()).second) options.push_back(option);
            }
            text += make_group(fmt::format("Options that recipes hold ({})", section->get_group()), false, options);
        }
        return text.empty() ? CLI::Formatter::make_subcommands(app, mode) : text;
    }

    std::string make_description(const CLI::App* app) const override { return app->get_description() + "\n\n"; }

    std::string make_option_desc(const CLI::Option* option) const override {
        return wrapped(option->get_description(), kHelpWidth - kHelpIndent);
    }

    std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
        const std::string names = CLI::Formatter::make_option_name(option, is_positional);
        return names.substr(0, names.find('{'));  // "--dither,--no-dither{false}"
    }

    std::string make_option_opts(const CLI::Option* option) const override {
        if (option->get_type_name().empty()) return "";  // a flag
        if (option->get_positional()) return option->get_expected_max() > 1 ? " ..." : "";
        std::string text = " " + placeholder(option->get_type_name());
        if (!option->get_default_str().empty()) text += " [" + option->get_default_str() + "]";
        return option->get_required() ? text + " (required)" : text;
    }

    std::string make_footer(const CLI::App* app) const override {
        const std::string footer = app->get_footer();
        const std::size_t first = footer.find_first_not_of('\n'), last = footer.find_last_not_of('\n');
        if (first == std::string::npos) return notes_on_options(*app);
        return notes_on_options(*app) + footer.substr(first, last + 1 - first) + "\n";
    }
};
}  // namespace

void format_help(CLI::App& app) {
    const auto formatter = std::make_shared<HelpFormatter>();
    app.formatter(formatter);
    for (CLI::App* command : app.get_subcommands([](CLI::App* c) { return !is_section(c); }))
        command->formatter(formatter)->group("Commands");
}

}  // namespace latent::cli
