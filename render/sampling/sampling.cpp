#include "render/sampling/sampling.h"

#include <numeric>

namespace latent::render {

Choice::Choice(const std::vector<double>& weight) : slots_(weight.size()) {
    constexpr std::uint64_t kWhole = std::uint64_t{1} << 32;
    const double mean = std::accumulate(weight.begin(), weight.end(), 0.0) / static_cast<double>(weight.size());
    std::vector<double> filled(weight.size());
    std::vector<std::uint32_t> small, large;
    for (std::uint32_t i = 0; i < weight.size(); ++i) {
        filled[i] = weight[i] / mean;
        slots_[i].other = i;
        (filled[i] < 1 ? small : large).push_back(i);
    }
    while (!small.empty() && !large.empty()) {
        const std::uint32_t poor = small.back(), rich = large.back();
        small.pop_back();
        const double keep = filled[poor] * static_cast<double>(kWhole);
        slots_[poor].keep = static_cast<std::uint32_t>(std::min(keep + 0.5, static_cast<double>(kWhole - 1)));
        if (weight[poor] > 0) slots_[poor].keep = std::max(slots_[poor].keep, 1u);
        slots_[poor].other = rich;
        filled[rich] -= 1 - filled[poor];
        if (filled[rich] < 1) {
            large.pop_back();
            small.push_back(rich);
        }
    }
    std::vector<std::uint64_t> share(weight.size());  // in units of 2^-32 of a slot
    for (std::uint32_t i = 0; i < weight.size(); ++i) {
        share[i] += slots_[i].keep;
        share[slots_[i].other] += kWhole - slots_[i].keep;
    }
    for (std::uint32_t i = 0; i < weight.size(); ++i) {
        const double slots = static_cast<double>(share[i]) / static_cast<double>(kWhole);
        slots_[i].probability = static_cast<float>(slots / static_cast<double>(weight.size()));
    }
}

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
