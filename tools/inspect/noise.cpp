#include "tools/inspect/noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/file.h"
#include "base/size.h"
#include "image/exr_writer.h"
#include "image/png_writer.h"
#include "sampledb/read/origin.h"
#include "sampledb/read/report_json.h"
#include "tools/inspect/info.h"

namespace latent::inspect {

using develop::NoiseLevel;
using develop::NoiseMap;
using develop::Percentiles;
using develop::PixelRect;
using nlohmann::json;

namespace {

constexpr double kTargets[] = {0.02, 0.01, 0.005};

// The mean over all files.
Result<std::optional<double>> cpu_seconds_per_sample(const std::vector<std::filesystem::path>& files, std::uint64_t memory) {
    double seconds = 0, samples = 0;
    for (const std::filesystem::path& file : files) {
        const Result<FileInfo> info = read_info(file, memory);
        if (!info) return info.error();
        const sampledb::Origin origin = sampledb::origin_of(info->contents);
        if (!origin.all_timed) return std::optional<double>();
        seconds += origin.cpu_seconds;
        samples += static_cast<double>(info->coverage.size()) - static_cast<double>(origin.committed_before);
    }
    return samples > 0 ? std::optional(seconds / samples) : std::nullopt;
}

// The map as an image, a pixel for each of the picture. EXR: the relative standard error. PNG: its share of what the noisiest
// hundredth exceeds, so that is white.
Status write_map(const NoiseReport& report, const std::filesystem::path& path, bool replace) {
    Result<OutputFile> file = OutputFile::create(path, replace);
    if (!file) return file.error();
    const NoiseMap& map = report.noise.map;
    const PixelRect& crop = report.noise.picture.crop;
    const auto width = static_cast<std::size_t>(crop.width()), height = static_cast<std::size_t>(crop.height());
    const bool png = path.extension() == ".png";
    const image::PixelFormat format{static_cast<int>(width), static_cast<int>(height),
                                    png ? image::SampleType::kU8 : image::SampleType::kF32, png ? 1 : 3};
    const image::Rect window{static_cast<int>(crop.x0), static_cast<int>(crop.y0), static_cast<int>(crop.x1),
                             static_cast<int>(crop.y1)};
    const image::Rect all{0, 0, static_cast<int>(report.noise.picture.width), static_cast<int>(report.noise.picture.height)};
    const auto writer =
        png ? image::create_png(*std::move(file), format, {}, {}) : image::create_exr(*std::move(file), window, all, false, {}, 1);
    if (!writer) return writer.error();
    const double white = map.relative().p99;
    Bytes pixels(format.row_bytes());
    for (std::size_t y = 0; y < height; ++y) {
        for (std::size_t x = 0; x < width && y % NoiseMap::kSide == 0; ++x) {
            const float seen = map.relative(x / NoiseMap::kSide, y / NoiseMap::kSide), value = std::isnan(seen) ? 0 : seen;
            std::byte* const to = pixels.data() + x * format.pixel_bytes();
            if (png) {
                const double share = white > 0 ? std::min(1.0, static_cast<double>(value) / white) : 0;
                *to = static_cast<std::byte>(std::lround(255 * share));
            } else {
                for (std::size_t c = 0; c < 3; ++c) std::memcpy(to + c * sizeof value, &value, sizeof value);
            }
        }
        if (Status s = (*writer)->write_rows(pixels); !s) return s;
    }
    if (Status s = (*writer)->finish(); !s) return s;
    return (*writer)->publish();
}

std::string percent(double share) { return fmt::format("{:#.3g} %", 100 * share); }

json json_of(const Percentiles& p) { return {{"median", p.median}, {"p95", p.p95}, {"p99", p.p99}}; }

}  // namespace

std::optional<PixelRect> NoiseReport::noisiest() const {
    std::optional<PixelRect> area;
    float most = -1;
    const PixelRect& crop = noise.picture.crop;
    for (std::size_t row = 0; row < noise.map.rows(); ++row) {
        for (std::size_t column = 0; column < noise.map.columns(); ++column) {
            const float relative = noise.map.relative(column, row);
            if (std::isnan(relative) || relative <= most) continue;
            most = relative;
            const std::int64_t x = crop.x0 + static_cast<std::int64_t>(column) * NoiseMap::kSide,
                               y = crop.y0 + static_cast<std::int64_t>(row) * NoiseMap::kSide;
            area = intersection({x, y, x + NoiseMap::kSide, y + NoiseMap::kSide}, crop);
        }
    }
    return area;
}

Result<NoiseReport> look_for_noise(const NoiseOptions& options, const Progress& progress) {
    if (!options.map.empty()) {
        if (const auto file = OutputFile::create(options.map, options.force); !file) return file.error();
    }
    constexpr int kHalvings = 4;
    Result<develop::Noise> noise = develop::measure_noise(options.picture, kHalvings, true, progress);
    if (!noise) return noise.error();
    NoiseReport report{*std::move(noise), {}, 0, options.map};
    report.bytes_per_sample =
        static_cast<double>(report.noise.picture.bytes_stored) / static_cast<double>(report.noise.picture.coverage.size());
    const Result<std::optional<double>> cpu = cpu_seconds_per_sample(report.noise.files, options.picture.memory);
    if (!cpu) return cpu.error();
    report.cpu_seconds_per_sample = *cpu;
    if (!options.map.empty()) {
        if (Status s = write_map(report, options.map, options.force); !s) return s.error();
    }
    return report;
}

std::string to_text(const NoiseReport& report) {
    const develop::PictureReport& picture = report.noise.picture;
    std::string text = fmt::format("{} x {} pixels of {} x {}, {}, {}\n", picture.crop.width(), picture.crop.height(),
                                   picture.width, picture.height, picture.filter, picture.observer);
    const std::optional<PixelRect> noisiest = report.noisiest();
    if (!noisiest) return text + "no light reaches the picture\n";
    text += "\nstandard error        relative, of Y     print, codes of 255\n";
    text += "samples per pixel    median       95 %     median       95 %\n";
    for (const NoiseLevel& level : report.noise.levels)
        text += fmt::format("{:>17} {:>9} {:>10} {:>10.2f} {:>10.2f}\n", format_count(level.samples_per_pixel),
                            percent(level.relative.median), percent(level.relative.p95), level.codes.median, level.codes.p95);
    const NoiseLevel& all = report.noise.levels.front();
    if (all.relative.median > 0) {
        text += report.noise.levels.size() >= develop::kLevelsForExponent
                    ? fmt::format("the median falls with samples^-{:.2f}\n", report.noise.exponent)
                    : "too few samples to see how the median falls; taken to fall with samples^-0.50\n";
        text += "\nfor a median of   samples per pixel   samples   CPU time       size\n";
        for (const double target : kTargets) {
            const double samples = report.noise.samples_for(target), ratio = samples / static_cast<double>(all.samples);
            const auto& each = report.cpu_seconds_per_sample;
            text += fmt::format("{:>15} {:>19} {:>9} {:>10} {:>10}\n", fmt::format("{:g} %", 100 * target),
                                format_count(ratio * all.samples_per_pixel), format_count(samples),
                                each ? format_duration(samples * *each) : "unknown",
                                format_size(static_cast<std::uint64_t>(samples * report.bytes_per_sample)));
        }
    }
    text += fmt::format("\n1 % of the pixels are noisier than {}; noisiest: --crop {},{},{},{}\n", percent(all.relative.p99),
                        noisiest->x0, noisiest->y0, noisiest->x1, noisiest->y1);
    return text;
}

json to_json(const NoiseReport& report) {
    const develop::PictureReport& picture = report.noise.picture;
    json levels = json::array(), targets = json::array();
    for (const NoiseLevel& level : report.noise.levels)
        levels.push_back({{"samples", level.samples},
                          {"samples_per_pixel", level.samples_per_pixel},
                          {"relative", json_of(level.relative)},
                          {"codes", json_of(level.codes)}});
    const NoiseLevel& all = report.noise.levels.front();
    for (const double target : kTargets) {
        if (!(all.relative.median > 0)) break;
        const double samples = report.noise.samples_for(target);
        const auto& each = report.cpu_seconds_per_sample;
        targets.push_back({{"median", target},
                           {"samples", samples},
                           {"cpu_seconds", each ? json(samples * *each) : json()},
                           {"bytes", samples * report.bytes_per_sample}});
    }
    json out = {{"width", picture.width},
                {"height", picture.height},
                {"crop", {picture.crop.x0, picture.crop.y0, picture.crop.x1, picture.crop.y1}},
                {"filter", picture.filter},
                {"observer", picture.observer},
                {"job", to_hex(picture.job)},
                {"levels", levels},
                {"exponent", report.noise.levels.size() >= develop::kLevelsForExponent ? json(report.noise.exponent) : json()},
                {"targets", targets},
                {"map", report.map.empty() ? json() : json(report.map.string())},
                {"left_out", picture.run_set.left_out}};
    const std::optional<PixelRect> noisiest = report.noisiest();
    out["noisiest"] = noisiest ? json({noisiest->x0, noisiest->y0, noisiest->x1, noisiest->y1}) : json();
    return out;
}

}  // namespace latent::inspect
