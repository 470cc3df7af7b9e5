#include "base/size.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace latent {

Result<std::uint64_t> parse_size(std::string_view text) {
    const Error wrong{ErrorCode::kUsage, fmt::format("'{}' is not a size (try 512M or 4G)", text)};
    std::uint64_t value = 0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || text.empty() || text.front() == '-') return wrong;
    const std::string_view unit = text.substr(static_cast<std::size_t>(rest - text.data()));
    if (unit.size() > 1) return wrong;
    int shift = 0;
    if (!unit.empty()) {
        const std::size_t place = std::string_view("KMGTkmgt").find(unit.front());
        if (place == std::string_view::npos) return wrong;
        shift = 10 * (static_cast<int>(place % 4) + 1);
    }
    if (shift > 0 && (value >> (64 - shift)) != 0) return wrong;
    return value << shift;
}

Result<double> parse_duration(std::string_view text) {
    const Error wrong{ErrorCode::kUsage, fmt::format("'{}' is not a time above 0 (try 60s, 10m or 2h)", text)};
    double value = 0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || !std::isfinite(value) || value <= 0) return wrong;
    const std::string_view unit = text.substr(static_cast<std::size_t>(rest - text.data()));
    if (unit.empty() || unit == "s") return value;
    if (unit == "m") return value * 60;
    if (unit == "h") return value * 3600;
    return wrong;
}

std::string format_size(std::uint64_t bytes) {
    if (bytes < 1024) return fmt::format("{} B", bytes);
    double value = static_cast<double>(bytes);
    const char* units[] = {"B", "KiB", "MiB", "GiB", "TiB", "PiB"};
    int unit = 0;
    while (value >= 1024 && unit < 5) {
        value /= 1024;
        ++unit;
    }
    return fmt::format("{:.1f} {}", value, units[unit]);
}

std::string format_duration(double seconds) {
    if (!(seconds >= 0)) return "?";
    if (seconds < 60) return fmt::format("{:.1f}s", seconds);
    const auto whole = static_cast<std::uint64_t>(seconds);
    if (whole < 3600) return fmt::format("{}m{:02}s", whole / 60, whole % 60);
    return fmt::format("{}h{:02}m", whole / 3600, whole / 60 % 60);
}

}  // namespace latent
