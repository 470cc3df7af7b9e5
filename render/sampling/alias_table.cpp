#include "render/sampling/alias_table.h"

#include <algorithm>
#include <numeric>

namespace latent::render {

AliasTable::AliasTable(const std::vector<double>& weight) : slots_(weight.size()) {
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

}  // namespace latent::render
