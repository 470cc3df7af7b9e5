#include "sampledb/data/wavelengths.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace latent::sampledb {

namespace {

constexpr std::uint64_t kOne = std::uint64_t{1} << 48;  // Q = 1
constexpr int kGuideShift = 36;                         // 4096 steps
constexpr double kUnitNm = 0x1p-20;
constexpr double kUnitQ = 0x1p-48;
constexpr std::uint32_t kMaxLambda = 4000u << 20;
constexpr std::size_t kMaxKnots = 4096;

// floor((xi / 2^32 + i) / k 2^48), the cumulative that wavelength i of the batch stands at.
std::uint64_t target(std::uint32_t xi, std::uint32_t i, std::uint32_t k) { return (((std::uint64_t{i} << 32) + xi) << 16) / k; }

}  // namespace

Result<WavelengthDensity> WavelengthDensity::from_knots(std::vector<Knot> knots) {
    const auto refuse = [](std::string why) { return Error{ErrorCode::kOutOfRange, "wavelength density: " + std::move(why)}; };
    if (knots.size() < 2 || knots.size() > kMaxKnots) return refuse(fmt::format("{} knots, not 2 to {}", knots.size(), kMaxKnots));
    if (knots.front().cumulative != 0 || knots.back().cumulative != kOne) return refuse("does not go from 0 to 1");
    if (knots.back().lambda > kMaxLambda) return refuse("a wavelength above 4000 nm");
    for (std::size_t i = 1; i < knots.size(); ++i) {
        if (knots[i].lambda <= knots[i - 1].lambda || knots[i].cumulative <= knots[i - 1].cumulative) {
            return refuse(fmt::format("knot {} does not lie above the one before", i));
        }
    }
    WavelengthDensity density;
    density.knots_ = std::move(knots);
    for (std::size_t j = 0; j + 1 < density.knots_.size(); ++j) {
        const Knot& a = density.knots_[j];
        const Knot& b = density.knots_[j + 1];
        const double slope = static_cast<double>(b.lambda - a.lambda) / static_cast<double>(b.cumulative - a.cumulative);
        density.segments_.push_back({a.cumulative, b.cumulative, static_cast<double>(a.lambda), slope});
    }
    std::uint16_t segment = 0;
    for (std::uint64_t step = 0; step < kOne >> kGuideShift; ++step) {
        while (density.segments_[segment].end <= step << kGuideShift) ++segment;
        density.guide_.push_back(segment);
    }
    return density;
}

std::size_t WavelengthDensity::segment_of(std::uint64_t q) const {
    std::size_t j = guide_[q >> kGuideShift];
    while (segments_[j].end <= q) ++j;
    return j;
}

float WavelengthDensity::Segment::lambda_nm_at(std::uint64_t q) const {
    return static_cast<float>((lambda + slope * static_cast<double>(q - begin)) * kUnitNm);
}

float WavelengthDensity::wavelength(std::uint32_t xi, std::uint32_t i, std::uint32_t k) const {
    assert(!empty() && i < k);
    const std::uint64_t q = target(xi, i, k);
    return segments_[segment_of(q)].lambda_nm_at(q);
}

void WavelengthDensity::batch(std::uint32_t xi, std::span<float> lambda_nm, std::span<std::uint16_t> segment) const {
    assert(!empty());
    const std::uint32_t k = static_cast<std::uint32_t>(lambda_nm.size());
    for (std::uint32_t i = 0; i < k; ++i) {
        const std::uint64_t q = target(xi, i, k);
        const std::size_t j = segment_of(q);
        lambda_nm[i] = segments_[j].lambda_nm_at(q);
        if (!segment.empty()) segment[i] = static_cast<std::uint16_t>(j);
    }
}

float WavelengthDensity::pdf_lambda(float lambda_nm) const {
    if (empty()) return 0;
    const double lambda = static_cast<double>(lambda_nm) / kUnitNm;
    const double first = knots_.front().lambda, last = knots_.back().lambda;
    if (!(lambda >= first && lambda <= last)) return 0;
    const auto above = std::upper_bound(knots_.begin(), knots_.end(), lambda,
                                        [](double l, const Knot& knot) { return l < static_cast<double>(knot.lambda); });
    const std::size_t j = std::min<std::size_t>(static_cast<std::size_t>(above - knots_.begin()), segments_.size()) - 1;
    return static_cast<float>(kUnitQ / (segments_[j].slope * kUnitNm));
}

}  // namespace latent::sampledb
