#include "tools/develop/forecast/forecast.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

Status check_space(const std::filesystem::path& output, bool replace, std::uint64_t bytes) {
    const std::optional<std::uint64_t> free = free_space(output, replace);
    if (!free || bytes <= *free) return {};
    return Error{ErrorCode::kNoSpace,
                 fmt::format("{}: needs about {}, but only {} are free in {}; free some space, or choose a smaller "
                             "--size or --crop; to start anyway, use --ignore-space",
                             output.string(), format_size(bytes), format_size(*free), folder_of(output).string())};
}

double seconds_to_reach_disk(std::uint64_t bytes, const std::filesystem::path& folder) {
    constexpr double kSeconds = 0.2;
    constexpr std::uint64_t kAtOnce = 4 << 20;
    Result<File> file = File::create_unnamed(folder);
    if (!file) return 0;
    std::vector<std::byte> noise(std::min(bytes, kAtOnce));  // that no file system compresses
    std::mt19937 random;
    for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
    std::vector<double> waited;  // for a block
    const Stopwatch stopwatch;
    std::uint64_t written = 0;
    while (written < bytes && (stopwatch.seconds() < kSeconds || waited.empty())) {
        const std::uint64_t size = std::min(kAtOnce, bytes - written);
        if (!file->write_all(written, std::span(noise).first(size))) return 0;
        const CostMeter meter;
        if (!file->sync_data()) return 0;
        written += size;
        waited.push_back(meter.so_far().waiting());
    }
    if (waited.empty()) return 0;
    std::ranges::sort(waited);  // the median: a disk that halts for a moment says nothing about the rest
    return waited[waited.size() / 2] * std::ceil(static_cast<double>(bytes) / static_cast<double>(kAtOnce));
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

Result<TrialOutcome> extrapolate(const TrialPicture& picture, double decoded, const PictureTrial& trial) {
    constexpr double kSeconds = 1.4, kDecodeSeconds = 0.6, kEnough = 0.25;
    constexpr double kSmall = 1 << 16;  // pixels
    constexpr double kMinBytes = 1 << 22;
    constexpr double kMinPixels = 1 << 19, kMaxPixels = 1 << 21;
    constexpr double kMaxFixed = 0.1;  // of the last trial: what seems more is the machine's load, which changes between trials
    TrialOutcome last;
    const TrialPicture small = scaled_to(picture, kSmall);
    const double run = std::max(1.0, decoded / static_cast<double>(picture.runs));  // bytes
    const Trial decode = [&](double bytes) -> Result<Tried> {
        TrialPicture some = small;
        some.runs = static_cast<std::size_t>(std::clamp(bytes / run, 1.0, static_cast<double>(picture.runs)));
        if (bytes < run) some.crop = piece_of(small.crop, area(small.crop) * bytes / run);
        const Result<TrialOutcome> tried = trial(some);
        if (!tried) return tried.error();
        last = *tried;
        return Tried{static_cast<double>(tried->decoded), tried->cost};
    };
    const double least = std::min(kMinBytes, run);
    const Result<Tried> first = decode(least / 16);
    if (!first) return first.error();
    const Result<LinearCost> bytes = measure(kDecodeSeconds, least, decoded, kEnough, decode);
    if (!bytes) return bytes.error();
    const Cost once = at_least(first->cost - bytes->of(first->amount), {});  // done once in a process
    TrialOutcome out = last;
    out.cost = once + bytes->of(decoded);
    if (small.width == picture.width) return out;

    // As many pixels as there may be time for, from so many runs that these give each pixel as many bytes as all give it in the
    // end: emptier pixels would compress faster, and fuller ones take longer.
    const double pixels_in_all = area(picture.crop);
    const double affordable = std::clamp(kEnough / std::max(bytes->each.cpu, 1e-12) / decoded * pixels_in_all, 1.0, kMaxPixels);
    const auto runs = static_cast<double>(picture.runs);
    const double share = std::clamp(std::ceil(affordable / pixels_in_all * runs), 1.0, runs) / runs;
    TrialPicture part = scaled_to(picture, pixels_in_all * share);
    part.runs = static_cast<std::size_t>(std::round(share * runs));
    const Trial develop = [&, whole = part.crop](double amount) -> Result<Tried> {
        part.crop = piece_of(whole, amount);
        const Result<TrialOutcome> tried = trial(part);
        if (!tried) return tried.error();
        last = *tried;
        return Tried{area(part.crop), tried->cost};
    };
    const Result<LinearCost> pixels =
        measure(kSeconds - bytes->spent.wall, std::min(affordable / 4, kMinPixels), area(part.crop), kEnough, develop);
    if (!pixels) return pixels.error();
    const double tried = area(part.crop), times = pixels_in_all / tried;
    const Cost last_cost = pixels->of(tried), fixed = at_most(pixels->fixed, last_cost * kMaxFixed);
    const Cost pixels_cost = fixed + (last_cost - fixed) * times;
    // Pieces may decode more than their share of the bytes: pages at their borders, and in a refocused picture many more.
    const Cost drawing = at_least(pixels_cost - bytes->each * (static_cast<double>(last.decoded) * times), {});
    out.cost = once + drawing + bytes->each * decoded;
    out.temporary_bytes = static_cast<std::uint64_t>(static_cast<double>(last.temporary_bytes) * times);
    return out;
}

}  // namespace latent::develop
