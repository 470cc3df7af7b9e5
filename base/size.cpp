#include "base/size.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace latent {

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

std::string format_count(double count) {
    constexpr const char* kUnits[] = {"", " K", " M", " G", " T"};
    std::size_t unit = 0;
    for (; count >= 999.5 && unit + 1 < std::size(kUnits); count /= 1000) ++unit;
    const int decimals = unit == 0 && count == std::floor(count) ? 0 : count < 9.995 ? 2 : count < 99.95 ? 1 : 0;
    return fmt::format("{:.{}f}{}", count, decimals, kUnits[unit]);
}

std::string counted(std::uint64_t count, std::string_view noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string format_samples_per_pixel(double count) {
    return fmt::format("{} sample{} per pixel", format_count(count), count == 1 ? "" : "s");
}

}  // namespace latent
