// render/sampling/alias_table.h: a choice among many by weight, in one step [Walker77].
#pragma once

#include <cstdint>
#include <vector>

#include "render/sampling/uniform.h"

namespace latent::render {

// Chooses i with probability weight[i] / sum in one step [Walker77]. The table is one of integers, and `probability` is what it
// does: exact, but for its own rounding and 2^-32 of a number's bits, however many there are to choose from.
class AliasTable {
 public:
    AliasTable() = default;
    // Fewer than 2^32 weights, not negative, their sum positive.
    explicit AliasTable(const std::vector<double>& weight);
    std::uint32_t sample(Uniform u) const {
        const auto n = static_cast<std::uint32_t>(slots_.size());
        const std::uint32_t i = u.index(n);
        return u.within(n).fraction32() < slots_[i].keep ? i : slots_[i].other;
    }
    float probability(std::uint32_t i) const { return slots_[i].probability; }
    std::size_t size() const { return slots_.size(); }

 private:
    struct Slot {
        std::uint32_t keep = 0;  // in units of 2^-32 of the slot; the rest goes to `other`: the slot itself if nothing does
        std::uint32_t other = 0;
        float probability = 0;
    };
    std::vector<Slot> slots_;
};

}  // namespace latent::render
