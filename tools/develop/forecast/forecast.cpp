#include "tools/develop/forecast/forecast.h"

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
    const std::string all = f.pictures > 1 ? fmt::format("{} pictures, ", f.pictures) : "";
    std::string text =
        fmt::format("{}: {}{} x {} pixels of {} x {}", f.output, all, f.crop.width(), f.crop.height(), f.width, f.height);
    const auto duration = [](double seconds) { return seconds < 0.1 ? "less than 0.1s" : "about " + format_duration(seconds); };
    if (f.seconds) text += fmt::format(", {} ({} of CPU time)", duration(*f.seconds), duration(f.cpu_seconds.value_or(0)));
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
                           {"pictures", f.pictures},
                           {"width", f.width},
                           {"height", f.height},
                           {"crop", {f.crop.x0, f.crop.y0, f.crop.x1, f.crop.y1}},
                           {"expected_bytes", f.file_bytes},
                           {"expected_temporary_bytes", f.temporary_bytes},
                           {"expected_memory_bytes", std::min(f.memory, f.memory_for_all)},
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
    constexpr double kSeconds = 0.2, kMaxSeconds = 0.6;
    constexpr std::size_t kEnough = 3;  // blocks
    constexpr std::uint64_t kAtOnce = 4 << 20;
    Result<File> file = File::create_unnamed(folder);
    if (!file) return 0;
    std::vector<std::byte> noise(std::min(bytes, kAtOnce));  // that no file system compresses
    std::mt19937 random;
    for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
    std::vector<double> waited;  // for a block
    const Stopwatch stopwatch;
    std::uint64_t written = 0;
    while (written < bytes && stopwatch.seconds() < (waited.size() < kEnough ? kMaxSeconds : kSeconds)) {
        const std::uint64_t size = std::min(kAtOnce, bytes - written);
        if (!file->write_all(written, std::span(noise).first(size))) return 0;
        const CostMeter meter;
        if (!file->sync_data()) return 0;
        written += size;
        waited.push_back(meter.so_far().waiting());
    }
    if (waited.empty()) return 0;
    std::ranges::sort(waited);  // the median: a disk that halts for a moment says nothing about the rest
    return waited[(waited.size() - 1) / 2] * std::ceil(static_cast<double>(bytes) / static_cast<double>(kAtOnce));
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

// The records of so many runs are drawn: those of cells that reach the crop.
double drawn_runs(const TrialPicture& picture) {
    const FilmGrid grid(picture.width, picture.height, picture.reach);
    return static_cast<double>(picture.runs) * std::ldexp(area(grid.cells_reaching(picture.crop)), -2 * grid.level());
}

// What the film's halves, halved by turns from left to right and from top to bottom, have in common with the crop: of the largest
// that has at most so many pixels, those that records of other parts do not reach. Around a point that is at no border of large
// parts. So pages that are parts of the film are drawn whole, or not decoded.
PixelRect piece_of(const TrialPicture& picture, double pixels) {
    constexpr double kAt = 0.52;
    const PixelRect& crop = picture.crop;
    if (pixels >= area(crop)) return crop;
    const FilmGrid grid(picture.width, picture.height, picture.reach);
    const double film = double{1} * picture.width * picture.height;
    const int halvings = std::min(static_cast<int>(std::ceil(std::log2(film / pixels))), 2 * grid.level());
    const std::int64_t x = crop.x0 + static_cast<std::int64_t>(kAt * static_cast<double>(crop.width()));
    const std::int64_t y = crop.y0 + static_cast<std::int64_t>(kAt * static_cast<double>(crop.height()));
    const auto part = [&](std::int64_t at, std::uint32_t all, int times) {
        const std::int64_t cells = std::int64_t{1} << (grid.level() - times);
        const std::int64_t first = at * (std::int64_t{1} << grid.level()) / all / cells * cells;
        return std::pair(first, first + cells);
    };
    const auto [x0, x1] = part(x, picture.width, (halvings + 1) / 2);
    const auto [y0, y1] = part(y, picture.height, halvings / 2);
    const PixelRect piece = intersection(grid.inner_pixels({x0, y0, x1, y1}), crop);
    return piece.empty() ? PixelRect{x, y, x + 1, y + 1} : piece;
}

}  // namespace

Result<TrialOutcome> extrapolate(const TrialPicture& picture, double decoded, double segments, const PictureTrial& trial) {
    constexpr double kSeconds = 1.2, kDecodeSeconds = 0.3, kEnough = 0.3;
    constexpr double kDecodeEnough = 0.06;  // share of what a piece decodes at least
    constexpr double kFewPixels = 1 << 15;
    constexpr double kSegmentSeconds = 0.09e-6;  // for what lies anywhere in memory; measured
    TrialOutcome last;
    const auto runs = static_cast<double>(picture.runs);
    const double pixels_in_all = area(picture.crop);

    // One pixel shows what bytes cost that are decoded and not drawn.
    double decoded_for_one = 0;  // bytes, of each run
    const Trial decode = [&](double amount) -> Result<Tried> {
        TrialPicture one = picture;
        one.crop = piece_of(picture, 1);
        one.runs = static_cast<std::size_t>(amount);
        const Result<TrialOutcome> tried = trial(one);
        if (!tried) return tried.error();
        decoded_for_one = static_cast<double>(tried->decoded) / std::floor(amount);
        return Tried{std::floor(amount), tried->cost};
    };
    const Result<Tried> first = decode(1);
    if (!first) return first.error();
    const Result<LinearCost> decoding = measure(kDecodeSeconds, 1, runs, kDecodeEnough, decode);
    if (!decoding) return decoding.error();
    const Cost once = at_least(first->cost - decoding->of(1), {});  // done once in a process
    // With one run, nothing tells decoding from other work: all is taken as drawing.
    Cost byte = runs > 1 ? decoding->each * (1 / std::max(decoded_for_one, 1.0)) : Cost{};

    // Pieces of a smaller picture, from so many runs that these give each pixel as many bytes as all give it in the end: emptier
    // pixels would compress faster, and fuller ones take longer. As many runs as possible, though: records of a cell that come from
    // many pages are more work.
    const double affordable = std::clamp(std::floor(kDecodeEnough / std::max(decoding->each.cpu, 1e-12)), 1.0, runs);
    TrialPicture part = scaled_to(picture, pixels_in_all * affordable / runs);
    part.runs = static_cast<std::size_t>(affordable);
    double times = 1;  // so many of the last piece draw what the picture does
    const Trial develop = [&](double amount) -> Result<Tried> {
        TrialPicture piece = part;
        piece.crop = piece_of(part, amount);
        const Result<TrialOutcome> tried = trial(piece);
        if (!tried) return tried.error();
        last = *tried;
        times = drawn_runs(picture) / drawn_runs(piece);
        // One pixel of few runs is mostly other work than decoding.
        byte = at_most(byte, tried->cost * (1 / std::max(static_cast<double>(tried->decoded), 1.0)));
        const Cost known = decoding->fixed + byte * static_cast<double>(tried->decoded);
        return Tried{pixels_in_all / times, tried->cost, known};
    };
    // A page's part of the film is the least that draws what it must decode.
    const double page_pixels = decoded_for_one * runs / std::max(decoded, 1.0) * area(part.crop);
    const Result<LinearCost> pixels = measure(kSeconds - kDecodeSeconds, std::min(kFewPixels, 2 * page_pixels), area(part.crop),
                                              kEnough, develop, byte.alone() * decoded * affordable / runs);
    if (!pixels) return pixels.error();
    const double more_segments = std::max(0.0, segments - static_cast<double>(last.segments) * times);
    const double seeking = kSegmentSeconds * more_segments;
    TrialOutcome out;
    out.cost = once + decoding->fixed + pixels->of(pixels_in_all) + byte * decoded + Cost{seeking, seeking};
    out.decoded = static_cast<std::uint64_t>(decoded);
    out.temporary_bytes = static_cast<std::uint64_t>(static_cast<double>(last.temporary_bytes) * times);
    return out;
}

}  // namespace latent::develop
