#include "tools/develop/forecast.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/json.h"
#include "base/size.h"
#include "base/stopwatch.h"

namespace latent::develop {

std::string to_text(const Forecast& f) {
    std::string text = fmt::format("{}: {} x {} pixels", f.output, f.width, f.height);
    if (f.seconds)
        text += fmt::format(", about {} ({} of CPU time)", format_duration(*f.seconds), format_duration(f.cpu_seconds.value_or(0)));
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
    if (f.cpu_seconds) json["expected_cpu_seconds"] = *f.cpu_seconds;
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

Cost cost_to_write(std::uint64_t bytes, const std::filesystem::path& folder) {
    constexpr double kSeconds = 0.3;
    constexpr std::uint64_t kAtOnce = 4 << 20;
    Result<File> file = File::create_unnamed(folder);
    if (!file) return {};
    std::vector<std::byte> noise(std::min(bytes, kAtOnce));  // that no file system compresses
    std::mt19937 random;
    for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
    std::vector<double> seconds_each;  // of whole blocks
    const CostMeter meter;
    const Stopwatch stopwatch;
    double before = 0;
    std::uint64_t written = 0;
    while (written < bytes && (stopwatch.seconds() < kSeconds || seconds_each.empty())) {
        const std::uint64_t size = std::min(kAtOnce, bytes - written);
        if (!file->write_all(written, std::span(noise).first(size)) || !file->sync_data()) return {};
        written += size;
        seconds_each.push_back(stopwatch.seconds() - std::exchange(before, stopwatch.seconds()));
    }
    if (written == bytes) return {before, meter.so_far().cpu};
    const double blocks = static_cast<double>(bytes) / static_cast<double>(kAtOnce);
    const double cpu_each = meter.so_far().cpu / static_cast<double>(seconds_each.size());
    std::ranges::sort(seconds_each);  // the median: a disk that halts for a moment says nothing about the rest
    return Cost{seconds_each[seconds_each.size() / 2], cpu_each} * blocks;
}

namespace {

double area(const PixelRect& r) { return static_cast<double>(r.width()) * static_cast<double>(r.height()); }

// The same part of the film in a picture with about `pixels` there.
TrialPicture scaled_to(const TrialPicture& picture, double pixels) {
    const double factor = std::min(1.0, std::sqrt(pixels / area(picture.crop)));
    TrialPicture out = picture;
    if (factor == 1) return out;
    const auto side = [&](std::uint32_t all) { return std::max(1.0, std::round(all * factor)); };
    const double width = side(picture.width), height = side(picture.height);
    const auto bound = [](std::int64_t at, double from, double to, bool up) {
        const double scaled = static_cast<double>(at) * to / from;
        return static_cast<std::int64_t>(up ? std::ceil(scaled) : std::floor(scaled));
    };
    out.width = static_cast<std::uint32_t>(width), out.height = static_cast<std::uint32_t>(height);
    out.crop = {bound(picture.crop.x0, picture.width, width, false), bound(picture.crop.y0, picture.height, height, false),
                bound(picture.crop.x1, picture.width, width, true), bound(picture.crop.y1, picture.height, height, true)};
    return out;
}

// A piece of `crop` with about so many pixels, in its middle.
PixelRect piece_of(const PixelRect& crop, double pixels) {
    const double factor = std::min(1.0, std::sqrt(pixels / area(crop)));
    const auto side = [&](std::int64_t all) {
        return std::max<std::int64_t>(1, static_cast<std::int64_t>(static_cast<double>(all) * factor));
    };
    const std::int64_t w = side(crop.width()), h = side(crop.height());
    const std::int64_t x = crop.x0 + (crop.width() - w) / 2, y = crop.y0 + (crop.height() - h) / 2;
    return {x, y, x + w, y + h};
}

}  // namespace

Result<TrialOutcome> extrapolate(const TrialPicture& picture, double decode_factor, const PictureTrial& trial) {
    constexpr double kRunSeconds = 0.9, kPixelSeconds = 0.5;
    constexpr double kSmall = 1 << 18, kLeastPiece = 1 << 20;  // pixels
    TrialOutcome last, first;
    const auto with_runs = [&](TrialPicture small) {
        return [&, small](std::size_t runs) mutable -> Result<Cost> {
            small.runs = runs;
            const Result<TrialOutcome> taken = trial(small);
            if (!taken) return taken.error();
            last = *taken;
            if (runs == 1) first = *taken;
            return taken->cost;
        };
    };
    const auto all_runs = static_cast<double>(picture.runs);
    const TrialPicture small = scaled_to(picture, kSmall);
    const Result<RunCost> runs = measure_runs(kRunSeconds, picture.runs, with_runs(small));
    if (!runs) return runs.error();
    TrialOutcome out = last;
    out.cost = runs->picture + runs->run * (all_runs * decode_factor);
    if (small.width == picture.width) return out;

    // Of the piece's cost, its run takes what its pages take; the rest is that of its pixels, beside what any picture costs.
    TrialPicture piece = picture;
    piece.runs = 1;
    const double per_pixel = std::max(runs->picture.wall, 1e-4) / area(small.crop);
    piece.crop = piece_of(picture.crop, std::clamp(kPixelSeconds / per_pixel, kLeastPiece, 16 * kLeastPiece));
    const Result<TrialOutcome> taken = trial(piece);
    if (!taken) return taken.error();
    const double share =
        std::min(1.0, static_cast<double>(taken->decoded) / static_cast<double>(std::max<std::uint64_t>(1, first.decoded)));
    const double more = area(piece.crop) - area(small.crop);
    const Cost pixel = at_least((taken->cost - runs->run * share - runs->picture) * (1 / more), {});
    out.cost = out.cost + pixel * (area(picture.crop) - area(small.crop));
    out.temporary_bytes =
        static_cast<std::uint64_t>(static_cast<double>(taken->temporary_bytes) * area(picture.crop) / area(piece.crop));
    return out;
}

}  // namespace latent::develop
