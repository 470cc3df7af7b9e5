// base/parse_switches.h: lists of names on command lines, each of which switches something on.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "base/result.h"

namespace latent {

// What a name switches on.
template <class Switches>
using Switch = std::pair<std::string_view, bool Switches::*>;

// Names with commas between them, in any order, of those that `known` lists. `what`: a name of them, such as "a layer". Errors:
// kUsage.
template <class Switches, std::size_t kCount>
Result<Switches> parse_switches(std::string_view text, const Switch<Switches> (&known)[kCount], std::string_view what) {
    Switches switches;
    for (std::string_view rest = text;;) {
        const std::size_t comma = rest.find(',');
        const std::string_view name = rest.substr(0, comma);
        bool found = false;
        std::string names;
        for (const auto& [its_name, member] : known) {
            if (name == its_name) switches.*member = found = true;
            names.append(names.empty() ? "" : ",").append(its_name);
        }
        if (!found) return usage_error(fmt::format("'{}' is not {} (try {})", name, what, names));
        if (comma == std::string_view::npos) return switches;
        rest.remove_prefix(comma + 1);
    }
}

}  // namespace latent
