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

// A float's sign, exponent and first 6 bits of mantissa: a bin.
constexpr int kShift = 17;
constexpr std::size_t kAllBins = std::size_t{1} << (32 - kShift);
constexpr std::size_t kNegative = kAllBins / 2;           // bins of the negative ones
constexpr std::size_t kBinCount = 0x7F800000U >> kShift;  // bins of one sign, for finite values

std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }

double centre_of(std::size_t bin) {
    const float low = std::bit_cast<float>(static_cast<std::uint32_t>(bin) << kShift);
    const float high = std::bit_cast<float>(static_cast<std::uint32_t>(bin + 1) << kShift);
    return std::isfinite(high) ? (double{low} + high) / 2 : low;
}

}  // namespace

void LuminanceHistogram::add(std::span<const float> y) {
    if (recent_count_ + y.size() > std::numeric_limits<std::uint32_t>::max()) settle();
    recent_count_ += y.size();
    recent_.resize(kLanes * kAllBins);
    std::uint32_t* counts = recent_.data();
    std::uint64_t zeros = 0;
    const auto add_one = [&](float value, std::size_t lane) {
        const std::uint32_t bits = bits_of(value);
        zeros += bits == 0;
        ++counts[(bits >> kShift) * kLanes + lane];
    };
    for (; y.size() >= kLanes; y = y.subspan(kLanes)) {
        static_assert(kLanes == 4);
        add_one(y[0], 0), add_one(y[1], 1), add_one(y[2], 2), add_one(y[3], 3);
    }
    for (const float value : y) add_one(value, 0);
    zeros_ += zeros;
}

std::uint64_t LuminanceHistogram::bin(std::size_t index) const {
    std::uint64_t sum = settled_.empty() ? 0 : settled_[index];
    for (std::size_t lane = 0; lane < kLanes && recent_count_ > 0; ++lane) sum += recent_[index * kLanes + lane];
    return index == 0 ? sum - zeros_ : sum;
}

void LuminanceHistogram::settle() {
    settled_.resize(kAllBins);
    for (std::size_t i = 0; i < kAllBins; ++i) settled_[i] = bin(i);
    settled_[0] += zeros_;  // which bin 0 leaves out
    std::ranges::fill(recent_, 0);
    recent_count_ = 0;
}

LuminanceHistogram& LuminanceHistogram::operator+=(const LuminanceHistogram& other) {
    settled_.resize(kAllBins);
    for (std::size_t i = 0; i < kAllBins; ++i) settled_[i] += other.bin(i);
    settled_[0] += other.zeros_;
    zeros_ += other.zeros_;
    return *this;
}

std::uint64_t LuminanceHistogram::count() const {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < kBinCount; ++i) sum += bin(i);
    return sum;
}

std::uint64_t LuminanceHistogram::dark() const {
    std::uint64_t sum = zeros_;
    for (std::size_t i = 0; i < kBinCount; ++i) sum += bin(kNegative + i);
    return sum;
}

double LuminanceHistogram::log_average(double p_low, double p_high, double least) const {
    const double total = static_cast<double>(count()), low = p_low * total, high = p_high * total;
    double below = 0, weight = 0, sum = 0;
    for (std::size_t i = 0; i < kBinCount; ++i) {
        if (bin(i) == 0) continue;
        const double above = below + static_cast<double>(bin(i));
        const double inside = std::min(above, high) - std::max(below, low);  // the part of this bin between the percentiles
        if (inside > 0 && centre_of(i) >= least) {
            weight += inside;
            sum += inside * std::log2(centre_of(i));
        }
        below = above;
    }
    return weight > 0 ? std::exp2(sum / weight) : 0;
}

double LuminanceHistogram::luminance_of_rank(double rank, std::uint64_t below) const {
    if (static_cast<double>(below) >= rank) return 0;
    std::size_t last = 0;
    for (std::size_t i = 0; i < kBinCount && static_cast<double>(below) < rank; ++i) {
        if (bin(i) > 0) last = i;
        below += bin(i);
    }
    return centre_of(last);
}

double LuminanceHistogram::percentile(double p) const {
    return luminance_of_rank(p * static_cast<double>(dark() + count()), dark());
}

double LuminanceHistogram::lit_percentile(double p) const { return luminance_of_rank(p * static_cast<double>(count()), 0); }

Result<double> auto_sigma(const LuminanceHistogram& histogram, double exposure) {
    constexpr double kTrim = 0.01, kEightStops = 0x1p-8;
    const double average = histogram.log_average(kTrim, 1 - kTrim, kEightStops * histogram.lit_percentile(0.9));
    if (!(average > 0)) return Error{ErrorCode::kOutOfRange, "no pixel has a positive luminance, so the exposure cannot be chosen"};
    const double sigma = exposure / average;
    const std::string digits = fmt::format("{:.4g}", sigma);
    double rounded = sigma;
    std::from_chars(digits.data(), digits.data() + digits.size(), rounded);
    return rounded;
}

}  // namespace latent::color
