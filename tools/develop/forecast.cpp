#include "tools/develop/forecast.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/file.h"
#include "base/json.h"
#include "base/size.h"

namespace latent::develop {

std::string to_text(const Forecast& f) {
    std::string text = fmt::format("{}: {} x {} pixels, about {}; {} of memory", f.output, f.width, f.height,
                                   format_duration(f.seconds), format_size(std::min(f.memory, f.memory_for_all)));
    if (f.memory < f.memory_for_all)
        text += fmt::format(" (--memory; with {}, all records would fit)", format_size(f.memory_for_all));
    text += fmt::format("; {} on disk", format_size(f.file_bytes));
    if (f.temporary_bytes > 0) text += fmt::format(" and {} for temporary files", format_size(f.temporary_bytes));
    if (f.free_bytes) text += fmt::format(", {} free{}", format_size(*f.free_bytes), f.fits() ? "" : ": not enough");
    return text + "\n";
}

std::string to_json(const Forecast& f) {
    nlohmann::json json = {{"output", f.output},
                           {"width", f.width},
                           {"height", f.height},
                           {"expected_seconds", f.seconds},
                           {"expected_bytes", f.file_bytes},
                           {"expected_temporary_bytes", f.temporary_bytes},
                           {"memory", f.memory},
                           {"memory_for_all_records", f.memory_for_all},
                           {"fits", f.fits()}};
    if (f.free_bytes) json["free_bytes"] = *f.free_bytes;
    return json_text(json) + "\n";
}

std::optional<std::uint64_t> free_space(const std::filesystem::path& output, bool replace) {
    std::error_code error;
    const std::filesystem::space_info space = std::filesystem::space(folder_of(output), error);
    if (error) return std::nullopt;
    const std::uint64_t replaced = replace ? std::filesystem::file_size(output, error) : 0;
    return error ? space.available : space.available + replaced;
}

Status check_space(const std::filesystem::path& output, bool replace, std::uint64_t bytes) {
    const std::optional<std::uint64_t> free = free_space(output, replace);
    if (!free || bytes <= *free) return {};
    return Error{ErrorCode::kNoSpace,
                 fmt::format("{}: needs about {}, but only {} are free in {}; free some space, or choose a smaller "
                             "--size or --crop; to start anyway, use --ignore-space",
                             output.string(), format_size(bytes), format_size(*free), folder_of(output).string())};
}

Result<double> seconds_for(std::size_t runs, double seconds, const Trial& trial) {
    constexpr double kMostGrowth = 8;  // of a trial over the one before
    double first = 0;
    for (std::size_t tried = 1;;) {
        const Result<double> taken = trial(tried);
        if (!taken) return taken.error();
        seconds -= *taken;
        if (tried >= runs) return *taken;
        const auto count = static_cast<double>(tried), all = static_cast<double>(runs);
        if (tried == 1) first = *taken;
        const double each = tried == 1 ? *taken : std::max(0.0, (*taken - first) / (count - 1));
        const double next = std::min({count * kMostGrowth, count + (seconds - *taken) / std::max(each, 1e-12), all});
        if (tried > 1 && next < 2 * count) return *taken + each * (all - count);
        tried = static_cast<std::size_t>(std::max(next, 2.0));
    }
}

}  // namespace latent::develop
