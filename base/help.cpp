#include "base/help.h"

#include <algorithm>

namespace latent::cli {

namespace {

// What stands for the value: a name of our own ("SIZE", "A:B"), or what CLI11 makes of the type and its check: "INT:INT in [1 -
// 9]", "TEXT:{both,camera,light}", "TEXT:NAME.latent".
std::string placeholder(const std::string& type) {
    const std::string name = type.substr(0, type.find(':'));
    if (name != "TEXT" && name != "INT" && name != "UINT" && name != "FLOAT") return type;
    std::string check = type.substr(std::min(type.size(), name.size() + 1));
    if (check.empty()) return name == "TEXT" ? name : name == "FLOAT" ? "X" : "N";
    if (check.starts_with('{')) {
        std::ranges::replace(check, ',', '|');
        return check.substr(1, check.find('}') - 1);
    }
    const std::size_t range = check.find('[');
    if (range == std::string::npos) return check;
    check = check.substr(range + 1, check.find(']') - range - 1);
    return check.replace(check.find(" - "), 3, "..");
}

}  // namespace

std::string HelpFormatter::make_option_name(const CLI::Option* option, bool is_positional) const {
    std::string names = CLI::Formatter::make_option_name(option, is_positional);
    return names.substr(0, names.find('{'));  // "--dither,--no-dither{false}"
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
    if (option->get_type_name().empty()) return "";  // a flag
    if (option->get_positional()) return option->get_expected_max() > 1 ? " ..." : "";
    std::string text = " " + placeholder(option->get_type_name());
    if (!option->get_default_str().empty()) text += " [" + option->get_default_str() + "]";
    return option->get_required() ? text + " (required)" : text;
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
    const std::string footer = app->get_footer();
    const std::size_t first = footer.find_first_not_of('\n'), last = footer.find_last_not_of('\n');
    return first == std::string::npos ? "" : footer.substr(first, last + 1 - first) + "\n";
}

}  // namespace latent::cli
