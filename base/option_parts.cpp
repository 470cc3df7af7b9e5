#include "base/option_parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/parse.h"

namespace latent {

std::vector<std::string_view> parts_of(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    while (true) {
        const std::size_t end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

std::optional<NamedNumbers> named_numbers(std::string_view text) {
    const std::vector<std::string_view> parts = parts_of(text, ':');
    NamedNumbers named{parts[0]};
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const Result<double> number = parse_number(parts[i]);
        if (!number) return std::nullopt;
        named.numbers.push_back(*number);
    }
    return named;
}

Status check_parts_differ(std::string_view text) {
    std::vector<std::string_view> names;
    for (const std::string_view part : parts_of(text, ',')) {
        const std::string_view name = parse_number(part) ? "a number" : part.substr(0, part.find(':'));
        if (std::ranges::find(names, name) != names.end()) return usage_error(fmt::format("'{}': {} is given twice", text, name));
        const bool is_range =
            part.find(':') != std::string_view::npos && parse_number(name);  // a range, which may stand several times
        if (!name.empty() && !is_range) names.push_back(name);
    }
    return {};
}

}  // namespace latent
