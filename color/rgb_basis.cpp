#include "color/rgb_basis.h"

#include <algorithm>
#include <cmath>

namespace latent::color {

namespace {

// Weights of cubic B-splines, one every 470/21 nm from just before 360 nm to just behind 830 nm. Among all that are within [0,1]
// and add up to 1, these have nearly the colours of sRGB's primaries under D65, and then the least sum of squared second
// differences. Blue is what the others leave.
constexpr std::size_t kCount = 24;
constexpr double kStep = (kLambdaMax - kLambdaMin) / (kCount - 3);
using Weights = std::array<double, kCount>;
constexpr Weights kRed = {0.405, 0.318, 0.230, 0.141, 0.053, 0, 0, 0, 0, 0, 0, 0.174, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
constexpr Weights kGreen = {0, 0, 0, 0, 0, 0, 0.016, 0.688, 1, 1, 1, 0.762, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};

double b_spline(double x) {
    x = std::abs(x);
    if (x >= 2) return 0;
    if (x < 1) return 2.0 / 3 - x * x + x * x * x / 2;
    return (2 - x) * (2 - x) * (2 - x) / 6;
}

double spline(const Weights& weights, double nm) {
    double sum = 0;
    for (std::size_t k = 0; k < kCount; ++k) sum += weights[k] * b_spline((nm - kLambdaMin) / kStep - (static_cast<double>(k) - 1));
    return sum;
}

Spectrum clamped(const std::function<double(double)>& f) { return Spectrum::from_function(f, Outside::kClamped); }

}  // namespace

const std::array<Spectrum, 3>& rgb_basis() {
    static const std::array<Spectrum, 3> curves = {
        clamped([](double nm) { return spline(kRed, nm); }), clamped([](double nm) { return spline(kGreen, nm); }),
        clamped([](double nm) { return std::max(0.0, 1 - (spline(kRed, nm) + spline(kGreen, nm))); })};
    return curves;
}

Spectrum rgb_basis_spectrum(Rgb srgb) {
    const std::array<double, 3> weight = {std::max(srgb.r, 0.0), std::max(srgb.g, 0.0), std::max(srgb.b, 0.0)};
    return clamped([&weight](double nm) {
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i) sum += weight[i] * rgb_basis()[i](nm);
        return sum;
    });
}

}  // namespace latent::color
