#include "tools/develop/channels/light_setting.h"

#include <fmt/format.h>

#include <cmath>

#include "base/option_parts.h"
#include "base/parse.h"
#include "color/light_name.h"

namespace latent::develop {

Result<LightSetting> parse_light(std::string_view text) {
    const std::size_t equals = text.rfind('=');
    const auto refuse = [&](std::string_view what) {
        return usage_error(fmt::format("'{}': {} (try lamp=2.5, or sky=6500K,0.3)", text, what));
    };
    if (equals == std::string_view::npos || equals == 0) return refuse("not NAME=...");
    LightSetting setting{.name = std::string(text.substr(0, equals))};
    for (const std::string_view part : parts_of(text.substr(equals + 1), ',')) {
        const bool is_light = color::is_temperature(part) || color::light_by_name(part);
        const Result<double> number = parse_number(part);
        if (part.empty()) return refuse("a part is empty");
        if (is_light && !setting.spectrum.empty()) return refuse("two spectra");
        if (!is_light && number && *number < 0) return refuse("a factor cannot be negative");
        if (is_light) {
            setting.spectrum = part;
        } else if (number) {
            setting.factor *= *number;
            if (!std::isfinite(static_cast<float>(setting.factor))) return refuse("the factor is too large");
        } else {
            setting.curves.emplace_back(part);
        }
    }
    return setting;
}

}  // namespace latent::develop
