#include "render/load/pbrt/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "base/near_names.h"
#include "base/size.h"
#include "render/load/files/unread.h"

namespace latent::render {

ParameterList::ParameterList(const Directive& directive, const std::vector<Parameter>& inherited, Diagnostics& diagnostics)
    : directive_(directive), inherited_(inherited), diagnostics_(diagnostics) {
    for (std::size_t i = 0; i < directive.parameters.size(); ++i) {
        const Parameter& p = directive.parameters[i];
        for (std::size_t j = 0; j < i; ++j) {
            if (directive.parameters[j].name == p.name && directive.parameters[j].type == p.type) error(p, "given twice");
        }
    }
}

const Parameter* ParameterList::find(std::string_view name, std::initializer_list<std::string_view> types) const {
    const Parameter* found = nullptr;
    bool all_read = true;
    each([&](const Parameter& p) {
        if (p.name == name && std::find(types.begin(), types.end(), p.type) != types.end()) {
            p.used = true;
            if (found == nullptr) found = &p;
        }
        all_read = all_read && (p.used || p.inherited);
    });
    if (!all_read) asked_.push_back({std::string(name), types});
    return found;
}

std::optional<double> ParameterList::number(std::string_view name) const {
    const Parameter* p = find(name, {"float", "integer"});
    if (p == nullptr) return std::nullopt;
    if (p->numbers.size() == 1) return p->numbers[0];
    error(*p, "must be one number");
    return std::nullopt;
}

double ParameterList::number(std::string_view name, double otherwise, double low, double high) const {
    const std::optional<double> value = number(name);
    if (!value) return otherwise;
    if (*value >= low && *value <= high) return *value;
    diagnostics_.error(find(name, {"float", "integer"})->where,
                       fmt::format("{}: {} is not between {} and {}", name, *value, low, high));
    return otherwise;
}

std::int64_t ParameterList::integer(std::string_view name, std::int64_t otherwise, std::int64_t low, std::int64_t high) const {
    const Parameter* p = find(name, {"integer"});
    if (p == nullptr) return otherwise;
    const double value = p->numbers.size() == 1 ? p->numbers[0] : static_cast<double>(low) - 1;
    if (value >= static_cast<double>(low) && value <= static_cast<double>(high)) return static_cast<std::int64_t>(value);
    error(*p, fmt::format("must be one integer from {} to {}", low, high));
    return otherwise;
}

bool ParameterList::flag(std::string_view name, bool otherwise) const {
    const Parameter* p = find(name, {"bool"});
    if (p == nullptr) return otherwise;
    if (p->flags.size() == 1) return p->flags[0];
    error(*p, "must be true or false");
    return otherwise;
}

std::optional<std::string> ParameterList::string(std::string_view name) const {
    const Parameter* p = find(name, {"string"});
    if (p == nullptr) return std::nullopt;
    if (p->strings.size() == 1) return p->strings[0];
    error(*p, "must be one string");
    return std::nullopt;
}

Vec3d ParameterList::point(std::string_view name, const Vec3d& otherwise) const {
    const std::span<const double> values = array(name, "point3", 3);
    if (values.empty()) return otherwise;
    if (values.size() > 3) error(fmt::format("{}: must be one point", name));
    return {values[0], values[1], values[2]};
}

std::span<const double> ParameterList::array(std::string_view name, std::string_view type, std::size_t size) const {
    const Parameter* p = find(name, {type});
    if (p == nullptr) return {};
    if (!p->numbers.empty() && p->numbers.size() % size == 0) return p->numbers;
    error(*p, fmt::format("{} cannot be divided into groups of {}", counted(p->numbers.size(), "number"), size));
    return {};
}

void ParameterList::ignore(std::initializer_list<std::string_view> names, std::string_view why) const {
    std::string list;
    std::optional<SourceLocation> first;
    each([&](const Parameter& p) {
        if (p.used || std::ranges::find(names, p.name) == names.end()) return;
        p.used = true;
        list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", p.name);
        if (!first) first = p.where;
    });
    if (first) diagnostics_.note(*first, fmt::format("{}: ignored: {}: {}", directive_.name, list, why));
}

void ParameterList::report_unused() const {
    const std::string what =
        directive_.strings.empty() ? directive_.name : fmt::format("{} \"{}\"", directive_.name, directive_.strings[0]);
    std::map<const UnreadFeatures*, std::pair<SourceLocation, std::string>> unread;  // the first place, and the names
    each([&](const Parameter& p) {
        if (p.used) return;
        if (const UnreadFeatures* const known = find_unread(SceneLanguage::kPbrtV4, directive_.name, p.name)) {
            p.used = true;
            const bool is_off = p.flags.size() == 1 && !p.flags[0];
            if (is_off && !known->is_harmless) return;
            auto& [where, names] = unread.try_emplace(known, p.where, "").first->second;
            names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", p.name);
        } else if (!p.inherited) {
            diagnostics_.error(p.where,
                               fmt::format("\"{} {}\" of {} is not supported{}", p.type, p.name, what, near_parameters(p)));
        }
    });
    for (const auto& [known, said] : unread) {
        const std::string place = diagnostics_.place(said.first),
                          message = fmt::format("{}: ignored: {}", directive_.name, said.second);
        diagnostics_.say_of_unread(place + message, place, message, *known);
    }
}

std::string ParameterList::near_parameters(const Parameter& p) const {
    std::vector<std::string> names, types;
    for (const Asked& asked : asked_) {
        if (asked.name == p.name) types.insert(types.end(), asked.types.begin(), asked.types.end());
        if (std::ranges::find(names, asked.name) == names.end()) names.push_back(asked.name);
    }
    std::ranges::sort(types);
    types.erase(std::unique(types.begin(), types.end()), types.end());
    if (!types.empty()) return fmt::format("; its type must be {}", fmt::join(types, " or "));
    const std::string near = near_names(p.name, names);
    return near.empty() ? "" : fmt::format("; did you mean {}?", near);
}

}  // namespace latent::render
