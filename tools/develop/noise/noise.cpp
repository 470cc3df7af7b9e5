#include "tools/develop/noise/noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "color/adaptation.h"
#include "color/observer_file.h"
#include "color/quantise.h"

namespace latent::develop {

namespace {

constexpr std::size_t kChannels = 3, kHalf0 = kChannels, kHalf1 = 2 * kChannels, kOutputs = 3 * kChannels;
constexpr double kMinPerPixel = 4;  // samples: each half of a picture has two

std::uint64_t first_half(std::uint64_t samples, int halvings) { return samples >> halvings; }

// The range that ends behind the first `count` samples of a set.
sampledb::SampleRange first_of(const sampledb::Coverage& all, std::uint64_t count) {
    sampledb::SampleRange first{all.ranges().front().first, all.ranges().front().first};
    for (const sampledb::SampleRange& range : all.ranges()) {
        if (count == 0) break;
        const std::uint64_t taken = std::min(count, range.size());
        first.end = range.first + taken;
        count -= taken;
    }
    return first;
}

// -1 times the slope of the least squares line through (log samples, log median).
std::optional<double> fitted_exponent(std::span<const NoiseLevel> levels) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const NoiseLevel& level : levels) {
        if (!(level.relative.median > 0)) continue;
        const double u = std::log(static_cast<double>(level.samples)), v = std::log(level.relative.median);
        n += 1, x += u, y += v, xx += u * u, xy += u * v;
    }
    if (n < kLevelsForExponent) return std::nullopt;
    return -(n * xy - x * y) / (n * xx - x * x);
}

}  // namespace

Status NoiseMap::begin(const image::ExrTileSpec& spec, std::uint64_t) {
    assert(spec.channels.size() == kOutputs);
    width_ = static_cast<std::size_t>(spec.x1 - spec.x0);
    height_ = static_cast<std::size_t>(spec.y1 - spec.y0);
    columns_ = (width_ + kSide - 1) / kSide;
    rows_ = (height_ + kSide - 1) / kSide;
    relative_.assign(columns_ * rows_, 0);
    codes_.assign(sigma_ ? columns_ * rows_ : 0, 0);
    luminances_ = {};
    if (!sigma_) return {};
    color::PrintSettings settings{.sigma = *sigma_};
    const color::RgbSpace srgb = color::RgbSpace::srgb();
    if (const auto& neutral = spec.adopted_neutral) {
        const color::Chromaticity white{static_cast<double>((*neutral)[0]), static_cast<double>((*neutral)[1])};
        const Result<color::Matrix3> adaptation = color::adaptation_matrix(white, srgb.primaries.white);
        if (!adaptation) return adaptation.error();
        settings.adaptation = *adaptation;
    }
    const Result<color::Print> print = color::Print::create(srgb, settings);
    if (!print) return print.error();
    print_ = *print;
    return {};
}

Status NoiseMap::write(int tile_x, int tile_y, std::span<const float> pixels) {
    const std::size_t x0 = static_cast<std::size_t>(tile_x) * kTile, y0 = static_cast<std::size_t>(tile_y) * kTile;
    const std::size_t columns = std::min<std::size_t>(kTile, width_ - x0), rows = pixels.size() / kOutputs / columns;
    for (std::size_t top = 0; top < rows; top += kSide) {
        std::array<Sums, kTile / kSide> areas{};
        for (std::size_t row = top; row < std::min<std::size_t>(rows, top + kSide); ++row)
            add_row(pixels.subspan(row * columns * kOutputs, columns * kOutputs), areas);
        for (std::size_t i = 0; i * kSide < columns; ++i) {
            const Sums& area = areas[i];
            const std::size_t at = (y0 + top) / kSide * columns_ + x0 / kSide + i;
            const auto count = static_cast<double>(pixels_in(at));
            relative_[at] = area.y > 0 ? static_cast<float>(std::sqrt(area.y_square / count) / (area.y / count))
                                       : std::numeric_limits<float>::quiet_NaN();
            if (print_) codes_[at] = static_cast<float>(std::sqrt(area.code_square / (kChannels * count)));
        }
    }
    return {};
}

void NoiseMap::add_row(std::span<const float> pixels, std::span<Sums> areas) {
    const std::size_t columns = pixels.size() / kOutputs;
    std::array<std::vector<float>, kOutputs> planes;
    for (std::size_t i = 0; i < kOutputs; ++i) {
        planes[i].resize(columns);
        for (std::size_t x = 0; x < columns; ++x) planes[i][x] = pixels[x * kOutputs + i];
    }
    const std::vector<float>&y = planes[1], &y0 = planes[kHalf0 + 1], &y1 = planes[kHalf1 + 1];
    luminances_.add(y);
    for (std::size_t x = 0; x < columns; ++x) {
        const double error = 0.5 * (static_cast<double>(y0[x]) - static_cast<double>(y1[x]));
        areas[x / kSide].y += static_cast<double>(y[x]);
        areas[x / kSide].y_square += error * error;
    }
    if (!print_) return;
    constexpr double kPerCode = 257;  // codes of 16 bits in one of 8
    const color::Quantiser quantiser{color::Transfer::srgb(), color::Dither::kNone};
    std::array<std::vector<std::uint16_t>, 2> codes;
    for (std::size_t half = 0; half < 2; ++half) {
        std::vector<float>* const xyz = planes.data() + (half == 0 ? kHalf0 : kHalf1);
        color::PrintReport ignored;
        print_->row(xyz[0], xyz[1], xyz[2], xyz[0], xyz[1], xyz[2], ignored);
        codes[half].resize(kChannels * columns);
        quantiser.to_16_bits(xyz[0], xyz[1], xyz[2], 0, 0, codes[half]);
    }
    for (std::size_t i = 0; i < kChannels * columns; ++i) {
        const double error = (static_cast<double>(codes[0][i]) - static_cast<double>(codes[1][i])) / (2 * kPerCode);
        areas[i / kChannels / kSide].code_square += error * error;
    }
}

std::size_t NoiseMap::pixels_in(std::size_t area) const {
    const std::size_t x = area % columns_ * kSide, y = area / columns_ * kSide;
    return std::min<std::size_t>(kSide, width_ - x) * std::min<std::size_t>(kSide, height_ - y);
}

Percentiles NoiseMap::percentiles(const std::vector<float>& of) const {
    std::vector<std::pair<float, std::size_t>> sorted;  // with their pixels
    double all = 0;
    for (std::size_t i = 0; i < of.size(); ++i) {
        if (std::isnan(of[i])) continue;
        sorted.emplace_back(of[i], pixels_in(i));
        all += static_cast<double>(sorted.back().second);
    }
    std::ranges::sort(sorted);
    const auto at = [&](double p) {
        double below = 0;
        for (const auto& [value, pixels] : sorted) {
            below += static_cast<double>(pixels);
            if (below >= p * all) return static_cast<double>(value);
        }
        return std::numeric_limits<double>::quiet_NaN();
    };
    return {at(0.5), at(0.95), at(0.99)};
}

std::optional<double> NoiseMap::suggested_sigma() const {
    const Result<double> sigma = color::auto_sigma(luminances_);
    return sigma ? std::optional(*sigma) : std::nullopt;
}

double Noise::samples_for(double target) const {
    const NoiseLevel& all = levels.front();
    return static_cast<double>(all.samples) * std::pow(all.relative.median / target, 1 / std::max(exponent, 0.5));
}

Result<Noise> measure_noise(const PictureOptions& asked, int halvings, bool print, const Progress& progress) {
    sampledb::RunSetOptions selection;
    selection.inputs = asked.inputs;
    selection.skip_duplicates = asked.skip_duplicates;
    selection.job = asked.job;
    selection.samples = asked.samples;
    selection.memory = asked.memory;
    const auto run_set = sampledb::RunSet::open(selection);
    if (!run_set) return run_set.error();
    const sampledb::Coverage all = (*run_set)->coverage();
    if (all.size() < 2) return Error{ErrorCode::kOutOfRange, "two samples or more are needed to see noise"};

    PictureOptions options = asked;
    const Result<color::Observer> observer = color::observer_by_name_or_file(options.observer.name);
    if (!observer) return observer.error().at("--observer");
    options.observer.camera_xyz = observer->kind() == color::ObserverKind::kCamera;
    options.layers = Layers{.halves = true};
    if (options.size.empty()) {
        const Size size = default_size(**run_set);
        options.size = fmt::format("{}x{}", size.width, size.height);
    }
    const Result<Size> size = parse_size_on_film(options.size, (*run_set)->job());
    if (!size) return size.error();
    const double pixels = static_cast<double>(size->width) * size->height;
    while (halvings > 0 && static_cast<double>(first_half(all.size(), halvings)) < kMinPerPixel * pixels) --halvings;

    // From few samples to all.
    Noise noise;
    noise.files = (*run_set)->files();
    std::optional<double> sigma;
    for (int i = print ? halvings + 1 : halvings; i >= 0; --i) {
        const std::uint64_t samples = first_half(all.size(), i);
        if (samples == 0) continue;
        options.samples = first_of(all, samples);
        NoiseMap map(sigma);
        const double share = std::ldexp(1, -i - 1);  // share of all samples that are developed, like those before
        const Progress part = [&](double done, const std::string& detail) { progress(share * (1 + done), detail); };
        Result<PictureReport> picture = develop_picture(options, map, progress ? part : Progress());
        if (!picture) return picture.error();
        if (print) sigma = map.suggested_sigma();
        if (i > halvings) continue;
        const double per_pixel = static_cast<double>(samples) / pixels;
        noise.levels.insert(noise.levels.begin(), {samples, per_pixel, map.relative(), map.codes()});
        if (i == 0) noise.picture = *std::move(picture), noise.map = std::move(map);
    }
    noise.exponent = fitted_exponent(noise.levels).value_or(noise.exponent);
    return noise;
}

}  // namespace latent::develop
