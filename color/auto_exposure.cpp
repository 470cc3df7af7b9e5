#include "color/auto_exposure.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

namespace latent::color {
namespace {

// A positive float's exponent and first 6 bits of mantissa: a bin.
constexpr int kShift = 17;
constexpr std::size_t kBinCount = std::size_t{1} << (31 - kShift);

double centre_of(std::size_t bin) {
    const float low = std::bit_cast<float>(static_cast<std::uint32_t>(bin) << kShift);
    const float high = std::bit_cast<float>(static_cast<std::uint32_t>(bin + 1) << kShift);
    return std::isfinite(high) ? (double{low} + high) / 2 : low;
}

}  // namespace

LuminanceHistogram::LuminanceHistogram() : bins_(kBinCount) {}

void LuminanceHistogram::add(std::span<const float> y) {
    for (const float value : y) {
        if (value > 0 && value <= std::numeric_limits<float>::max()) ++bins_[std::bit_cast<std::uint32_t>(value) >> kShift];
    }
}

LuminanceHistogram& LuminanceHistogram::operator+=(const LuminanceHistogram& other) {
    for (std::size_t i = 0; i < kBinCount; ++i) bins_[i] += other.bins_[i];
    return *this;
}

std::uint64_t LuminanceHistogram::count() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t n : bins_) sum += n;
    return sum;
}

double LuminanceHistogram::log_average(double p_low, double p_high) const {
    const double total = static_cast<double>(count()), low = p_low * total, high = p_high * total;
    double below = 0, weight = 0, sum = 0;
    for (std::size_t i = 0; i < kBinCount; ++i) {
        if (bins_[i] == 0) continue;
        const double above = below + static_cast<double>(bins_[i]);
        const double inside = std::min(above, high) - std::max(below, low);  // the part of this bin between the percentiles
        if (inside > 0) {
            weight += inside;
            sum += inside * std::log2(centre_of(i));
        }
        below = above;
    }
    return weight > 0 ? std::exp2(sum / weight) : 0;
}

double LuminanceHistogram::percentile(double p, std::uint64_t dark) const {
    const double rank = p * static_cast<double>(dark + count());
    std::uint64_t below = dark;
    if (static_cast<double>(below) >= rank) return 0;
    std::size_t last = 0;
    for (std::size_t i = 0; i < kBinCount && static_cast<double>(below) < rank; ++i) {
        if (bins_[i] > 0) last = i;
        below += bins_[i];
    }
    return centre_of(last);
}

Result<double> auto_sigma(const LuminanceHistogram& histogram, double exposure) {
    constexpr double kTrim = 0.01;
    const double average = histogram.log_average(kTrim, 1 - kTrim);
    if (!(average > 0)) return Error{ErrorCode::kOutOfRange, "no pixel has a positive luminance, so the exposure cannot be chosen"};
    const double sigma = exposure / average;
    const std::string digits = fmt::format("{:.4g}", sigma);
    double rounded = sigma;
    std::from_chars(digits.data(), digits.data() + digits.size(), rounded);
    return rounded;
}

}  // namespace latent::color
