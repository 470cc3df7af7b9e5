#include "color/spectral_bins.h"

#include <algorithm>
#include <cassert>

namespace latent::color {
namespace {

// Integral of the three curves from one wavelength to another; they are linear between their knots, and zero beyond these.
std::array<double, 3> integral(const Observer& observer, double from_nm, double to_nm) {
    const std::span<const double> knots = observer.lambda_nm();
    const double from = std::max({from_nm, knots.front(), kLambdaMin}), to = std::min({to_nm, knots.back(), kLambdaMax});
    std::array<double, 3> sum{};
    auto next = std::ranges::upper_bound(knots, from);
    for (double at = from; at < to;) {
        const double end = next == knots.end() ? to : std::min(*next++, to);
        const std::array<double, 3> left = observer.at(at), right = observer.at(end);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += (end - at) * (left[c] + right[c]) / 2;
        at = end;
    }
    return sum;
}

}  // namespace

std::vector<std::array<double, 3>> bin_integrals(const Observer& observer, std::span<const double> centres_nm) {
    const std::size_t count = centres_nm.size();
    assert(count >= 2);
    std::vector<double> edges{1.5 * centres_nm[0] - 0.5 * centres_nm[1]};
    for (std::size_t i = 1; i < count; ++i) edges.push_back((centres_nm[i - 1] + centres_nm[i]) / 2);
    edges.push_back(1.5 * centres_nm[count - 1] - 0.5 * centres_nm[count - 2]);
    std::vector<std::array<double, 3>> integrals;
    for (std::size_t i = 0; i < count; ++i) integrals.push_back(integral(observer, edges[i], edges[i + 1]));
    return integrals;
}

}  // namespace latent::color
