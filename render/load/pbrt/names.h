// render/load/pbrt/names.h: names that may be used before they are defined.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/load/files/diagnostics.h"
#include "render/scene/source_location.h"

namespace latent::render {

// A name that something uses, and nothing defines.
struct UndefinedName {
    SourceLocation where{};  // where it is used first
    std::string name{};      // `material "gold"`
    std::string hint{};      // "; what might be meant", or nothing
};

class Names {
 public:
    // The index of `text`; `next`, at its first mention.
    std::uint32_t mention(const std::string& text, const SourceLocation& where, std::size_t next);
    // Defines a name, perhaps one that was mentioned. False, with an error of `directive`, if it is defined already.
    bool define(const std::string& text, std::string_view directive, const SourceLocation& where, Diagnostics& diagnostics);
    // Adds those that were mentioned alone. `what`: "material".
    void add_undefined(std::string_view what, std::vector<UndefinedName>& names) const;

 private:
    struct Named {
        std::uint32_t index;
        SourceLocation mentioned;
        std::optional<SourceLocation> defined{};
    };
    std::map<std::string, Named> named_;
};

}  // namespace latent::render
