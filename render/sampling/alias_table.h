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
    // `rest`: where in its part the number lies, with 32 bits at least.
    std::uint32_t sample(Uniform u, Uniform& rest) const {
        const auto n = static_cast<std::uint32_t>(slots_.size());
        const std::uint32_t i = u.index(n);
        const Slot& slot = slots_[i];
        rest = u.within(n);
        if (slot.keep == 0) return slot.other;
        const bool kept = rest.fraction32() < slot.keep;
        const std::uint64_t before = kept ? 0 : std::uint64_t{slot.keep} << 32, part = kept ? slot.keep : kWhole - slot.keep;
        rest.bits = (rest.bits - before) / part << 32;
        return kept ? i : slot.other;
    }
    std::uint32_t sample(Uniform u) const {
        Uniform rest;
        return sample(u, rest);
    }
    float probability(std::uint32_t i) const { return slots_[i].probability; }
    std::size_t size() const { return slots_.size(); }

 private:
    static constexpr std::uint64_t kWhole = std::uint64_t{1} << 32;
    struct Slot {
        std::uint32_t keep = 0;  // in units of 2^-32 of the slot; the rest goes to `other`: the slot itself if nothing does
        std::uint32_t other = 0;
        float probability = 0;
    };
    std::vector<Slot> slots_;
};

}  // namespace latent::render
