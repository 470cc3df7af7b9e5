#include "tools/develop/forecast.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <span>
#include <vector>

#include "base/file.h"
#include "base/json.h"
#include "base/size.h"
#include "base/stopwatch.h"

namespace latent::develop {

std::string to_text(const Forecast& f) {
    std::string text = fmt::format("{}: {} x {} pixels", f.output, f.width, f.height);
    if (f.seconds) text += fmt::format(", about {}", format_duration(*f.seconds));
    text += fmt::format("; {} of memory", format_size(std::min(f.memory, f.memory_for_all)));
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
                           {"expected_bytes", f.file_bytes},
                           {"expected_temporary_bytes", f.temporary_bytes},
                           {"memory", f.memory},
                           {"memory_for_all_records", f.memory_for_all},
                           {"fits", f.fits()}};
    if (f.seconds) json["expected_seconds"] = *f.seconds;
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

double seconds_to_write(std::uint64_t bytes, const std::filesystem::path& folder) {
    constexpr double kSeconds = 1;
    constexpr std::uint64_t kAtOnce = 8 << 20;
    Result<File> file = File::create_unnamed(folder);
    if (!file) return 0;
    std::vector<std::byte> noise(std::min(bytes, kAtOnce));  // that no file system compresses
    std::mt19937 random;
    for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
    const Stopwatch stopwatch;
    std::uint64_t written = 0;
    while (written < bytes && stopwatch.seconds() < kSeconds) {
        const std::uint64_t size = std::min(kAtOnce, bytes - written);
        if (!file->write_all(written, std::span(noise).first(size)) || !file->sync_data()) return 0;
        written += size;
    }
    return written == 0 ? 0 : stopwatch.seconds() * static_cast<double>(bytes) / static_cast<double>(written);
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
