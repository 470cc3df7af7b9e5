// base/option_parts.h: options whose value has several parts, "0.35,blades:6:15,gaussian".
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace latent {

// The text between separators; one part at least, which may be empty.
std::vector<std::string_view> parts_of(std::string_view text, char separator);

// "blades:6:15": a name, and numbers behind it, if there are any. Nothing if the text is anything else.
struct NamedNumbers {
    std::string_view name;
    std::vector<double> numbers{};
};
std::optional<NamedNumbers> named_numbers(std::string_view text);

// Errors: kUsage: of the parts between commas, two have the same name, or two are numbers alone. Ranges, "0:0.25", may repeat.
Status check_parts_differ(std::string_view text);

}  // namespace latent
