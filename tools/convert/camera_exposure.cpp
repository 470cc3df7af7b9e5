#include "tools/convert/camera_exposure.h"

#include <fmt/format.h>

#include "base/option_parts.h"
#include "base/parse.h"

namespace latent::convert {
namespace {

// "1/125", "0.5".
Result<double> parse_time(std::string_view text) {
    const std::size_t slash = text.find('/');
    if (slash == std::string_view::npos) return parse_number(text);
    const Result<double> above = parse_number(text.substr(0, slash)), below = parse_number(text.substr(slash + 1));
    if (!above || !below) return !above ? above.error() : below.error();
    return *above / *below;
}

}  // namespace

double CameraExposure::saturation() const { return 78 * f_number * f_number / (0.65 * iso * seconds); }

Result<CameraExposure> parse_camera_exposure(std::string_view text) {
    if (Status s = check_parts_differ(text); !s) return s.error();
    CameraExposure exposure;
    for (const std::string_view part : parts_of(text, ',')) {
        const std::size_t colon = part.find(':');
        const std::string_view name = part.substr(0, colon), value = colon == std::string_view::npos ? "" : part.substr(colon + 1);
        const auto take = [&](double& to, const Result<double>& number, double least, double most) {
            if (number) to = *number;
            return number && *number >= least && *number <= most;
        };
        if (name == "iso") {
            if (!take(exposure.iso, parse_number(value), 0.01, 1e7)) return is_not(part, "a speed, 0.01 to 10000000 (try iso:100)");
        } else if (name == "time") {
            if (!take(exposure.seconds, parse_time(value), 1e-6, 1e6))
                return is_not(part, "a time in seconds, 0.000001 to 1000000 (try time:1/125)");
        } else if (name == "f") {
            if (!take(exposure.f_number, parse_number(value), 0.5, 1000)) return is_not(part, "an f-number, 0.5 to 1000 (try f:8)");
        } else {
            return is_not(part, "iso, time or f (try iso:100,time:1/125,f:8)");
        }
    }
    if (exposure.iso == 0 || exposure.seconds == 0 || exposure.f_number == 0)
        return is_not(text, "an exposure, which needs iso, time and f (try iso:100,time:1/125,f:8)");
    return exposure;
}

}  // namespace latent::convert
