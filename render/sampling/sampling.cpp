#include "render/sampling/sampling.h"

#include <numeric>

namespace latent::render {

Choice::Choice(const std::vector<double>& weight) : slots_(weight.size()) {
    const double mean = std::accumulate(weight.begin(), weight.end(), 0.0) / static_cast<double>(weight.size());
    std::vector<double> filled(weight.size());
    std::vector<std::uint32_t> small, large;
    for (std::uint32_t i = 0; i < weight.size(); ++i) {
        filled[i] = weight[i] / mean;
        slots_[i] = {1, static_cast<float>(filled[i] / static_cast<double>(weight.size())), i};
        (filled[i] < 1 ? small : large).push_back(i);
    }
    while (!small.empty() && !large.empty()) {
        const std::uint32_t poor = small.back(), rich = large.back();
        small.pop_back();
        slots_[poor].keep = static_cast<float>(filled[poor]);
        slots_[poor].other = rich;
        filled[rich] -= 1 - filled[poor];
        if (filled[rich] < 1) {
            large.pop_back();
            small.push_back(rich);
        }
    }
}

}  // namespace latent::render
