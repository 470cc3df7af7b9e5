#include "tools/develop/lens/recorded_lens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/json.h"

namespace latent::develop {

namespace {

std::optional<RecordedLens> lens_in(std::string_view origin) {
    const nlohmann::json all = nlohmann::json::parse(origin, nullptr, false);
    if (!all.is_object() || !all.contains("lens") || !all["lens"].is_object()) return std::nullopt;
    const nlohmann::json& stored = all["lens"];
    const auto number = [](const nlohmann::json& x) { return x.is_number() ? x.get<double>() : 0.0; };
    const nlohmann::json window = stored.value("window", nlohmann::json());
    if (!window.is_array() || window.size() != 4) return std::nullopt;
    const RecordedLens lens{number(stored.value("radius", nlohmann::json())),
                            number(stored.value("focus", nlohmann::json())),
                            number(window[0]),
                            number(window[1]),
                            number(window[2]),
                            number(window[3])};
    if (!(lens.radius > 0 && lens.focus > 0 && lens.x0 < lens.x1 && lens.y0 < lens.y1)) return std::nullopt;
    return lens;
}

}  // namespace

double RecordedLens::distance(double u, double v, const std::array<double, 2>& l, double depth) const {
    const double x = x0 + u * (x1 - x0) - radius * l[0] / focus, y = y1 + v * (y0 - y1) - radius * l[1] / focus;
    return depth / std::sqrt(x * x + y * y + 1);
}

double RecordedLens::f_number() const { return 0.036 / std::max(x1 - x0, y1 - y0) / (2 * radius); }

Result<RecordedLens> recorded_lens(const sampledb::RunSet& run_set, const char* option) {
    std::optional<RecordedLens> lens;
    const auto take = [&](std::string_view origin) {
        if (!lens) lens = lens_in(origin);
    };
    if (Status s = for_each_origin(run_set, take); !s) return s.error();
    if (!lens)
        return usage_error(fmt::format(
            "{}: the files do not describe their camera's lens; render the scene again, with a camera that has a lens", option));
    return *lens;
}

}  // namespace latent::develop
