#include "render/load/pbrt/names.h"

#include <fmt/format.h>

namespace latent::render {

std::uint32_t Names::mention(const std::string& text, const SourceLocation& where, std::size_t next) {
    return named_.try_emplace(text, Named{static_cast<std::uint32_t>(next), where}).first->second.index;
}

bool Names::define(const std::string& text, std::string_view directive, const SourceLocation& where, Diagnostics& diagnostics) {
    std::optional<SourceLocation>& defined = named_.at(text).defined;
    if (defined) diagnostics.error(where, fmt::format("{} \"{}\": defined before, on line {}", directive, text, defined->line));
    const bool is_first = !defined;
    if (is_first) defined = where;
    return is_first;
}

void Names::add_undefined(std::string_view what, std::vector<UndefinedName>& names) const {
    for (const auto& [text, named] : named_) {
        if (!named.defined) names.push_back({named.mentioned, fmt::format("{} \"{}\"", what, text)});
    }
}

}  // namespace latent::render
