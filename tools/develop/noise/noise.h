// tools/develop/noise/noise.h: how noisy a picture is, how noise falls as samples are added, and how many a target needs.
// docs/developing.md, "Noise".
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "color/auto_exposure.h"
#include "color/print.h"
#include "tools/develop/picture/picture.h"

namespace latent::develop {

// Over pixels: what half of them exceed, and what 5 % and 1 % do; NaN if there are none.
struct Percentiles {
    double median = 0, p95 = 0, p99 = 0;
};

// Takes a picture of X, Y, Z with Layers::halves, and keeps its standard error: the root mean square of (half0 - half1) / 2 in
// areas of kSide x kSide pixels, counted from the corner of the crop.
class NoiseMap final : public PictureSink {
 public:
    static constexpr int kSide = 16;  // divides kTile

    // `sigma`: the sensitivity of the print whose code values are looked at; none: no print.
    explicit NoiseMap(std::optional<double> sigma) : sigma_(sigma) {}

    Status begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) override;
    Status write(int x, int y, std::span<const float> pixels) override;
    Status finish() override { return {}; }

    std::size_t columns() const { return columns_; }  // areas in a row
    std::size_t rows() const { return rows_; }
    // The standard error of Y, divided by the mean Y of the area; NaN where that is not positive.
    float relative(std::size_t column, std::size_t row) const { return relative_[row * columns_ + column]; }
    Percentiles relative() const { return percentiles(relative_); }
    // The standard error of code values of the print (sRGB, 0 to 255): the root mean square of the three channels.
    Percentiles codes() const { return percentiles(codes_); }

    // The sensitivity for a print of this picture; none without light.
    std::optional<double> suggested_sigma() const;

 private:
    struct Sums {
        double y = 0, y_square = 0, code_square = 0;  // sums of Y, and of squared errors
    };
    void add_row(std::span<const float> pixels, std::span<Sums> areas);  // a tile's row
    std::size_t pixels_in(std::size_t area) const;
    Percentiles percentiles(const std::vector<float>& of) const;

    std::optional<double> sigma_;
    std::optional<color::Print> print_;
    color::LuminanceHistogram luminances_;
    std::size_t width_ = 0, height_ = 0, columns_ = 0, rows_ = 0;
    std::vector<float> relative_, codes_;  // one for each area, row after row
};

// Noise with so many samples.
struct NoiseLevel {
    std::uint64_t samples = 0;
    double samples_per_pixel = 0;
    Percentiles relative, codes;
};

inline constexpr std::size_t kLevelsForExponent = 3;

struct Noise {
    PictureReport picture;  // made from all samples
    std::vector<std::filesystem::path> files;
    NoiseMap map{std::nullopt};      // the same
    std::vector<NoiseLevel> levels;  // for all samples, the first half of them, the first quarter, ...
    double exponent = 0.5;           // p: the median falls with samples^-p; 1/2 if there are fewer than kLevelsForExponent

    // Samples with which the median of the relative standard error is `target`. A measured exponent below 1/2 is that of rare
    // bright samples that most areas have yet to see; all errors of independent samples end up at 1/2, so that counts then.
    double samples_for(double target) const;
};

// Develops the picture of `options` (their crop, samples, filter and observer; no output and no other layers) from all samples,
// from the first half of them, and so on, `halvings` times or as long as there are four for each pixel. With `print`, once more:
// each print is exposed as the picture of half as many samples suggests; else there are no code values. Errors: of develop_picture;
// kOutOfRange if there are fewer than two samples.
Result<Noise> measure_noise(const PictureOptions& options, int halvings, bool print, const Progress& progress);

}  // namespace latent::develop
