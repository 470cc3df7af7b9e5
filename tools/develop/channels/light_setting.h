// tools/develop/channels/light_setting.h: what --light says of a group of lights. docs/developing.md, "Light mix".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace latent::develop {

// "lamp=2.5", "sky=6500K,0.3", "lamp=wratten-80a": a name, and what happens to the light of that group, in this order: a spectrum
// instead of its own (a temperature, D65, A, E, F1 to F12), curves (a filter, a CSV file of nm and factor), factors.
struct LightSetting {
    std::string name;
    std::string spectrum{};             // "": its own
    std::vector<std::string> curves{};  // names of filters and files
    double factor = 1;
};
// Errors: kUsage.
Result<LightSetting> parse_light(std::string_view text);

}  // namespace latent::develop
