// render/load/pbrt/names.h: names that may be used before they are defined.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "render/load/files/diagnostics.h"
#include "render/scene/source_location.h"

namespace latent::render {

class Names {
 public:
    // The index of `text`; `next`, at its first mention.
    std::uint32_t mention(const std::string& text, const SourceLocation& where, std::size_t next);
    // Of a name that was mentioned. False, with an error of `directive`, if it is defined already.
    bool define(const std::string& text, std::string_view directive, const SourceLocation& where, Diagnostics& diagnostics);
    // An error for each that was mentioned alone. `what`: "material".
    void report_undefined(std::string_view what, Diagnostics& diagnostics) const;

 private:
    struct Named {
        std::uint32_t index;
        SourceLocation mentioned;
        std::optional<SourceLocation> defined{};
    };
    std::map<std::string, Named> named_;
};

}  // namespace latent::render
