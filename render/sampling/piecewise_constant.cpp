#include "render/sampling/piecewise_constant.h"

#include <algorithm>
#include <numeric>

namespace latent::render {

PiecewiseConstant::PiecewiseConstant(std::span<const double> weight) {
    const double sum = std::accumulate(weight.begin(), weight.end(), 0.0);
    double so_far = 0;
    std::uint64_t begin = 0;
    for (std::size_t i = 0; i < weight.size(); ++i) {
        // Room for one unit of every step before and behind.
        const std::uint64_t last = (std::uint64_t{1} << 32) - (weight.size() - i);
        if (i > 0) begin = std::clamp(static_cast<std::uint64_t>(so_far / sum * 0x1p32 + 0.5), begin + 1, last);
        begin_.push_back(static_cast<std::uint32_t>(begin));
        so_far += weight[i];
    }
}

std::uint32_t PiecewiseConstant::sample(Uniform u, Uniform& within) const {
    const auto above = std::upper_bound(begin_.begin() + 1, begin_.end(), u.fraction32());
    const auto i = static_cast<std::uint32_t>(above - begin_.begin() - 1);
    // The distance into the step has 32 bits below the steps' unit: over the width, floor to 2^-64, which it never reaches.
    const std::uint64_t into = u.bits - (std::uint64_t{begin_[i]} << 32);
    within.bits = static_cast<std::uint64_t>((static_cast<unsigned __int128>(into) << 32) / width(i));
    return i;
}

}  // namespace latent::render
