// render/sampling/piecewise_constant.h: a step function as a distribution.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/sampling/uniform.h"

namespace latent::render {

// A distribution over [0, n) that is even within each of n steps: the step of a uniform number, and where in it the number lies,
// which is a number of its own. Neighbours stay neighbours. Weights are rounded to 2^-32 of their sum, and no step is empty.
class PiecewiseConstant {
 public:
    PiecewiseConstant() = default;
    // Fewer than 2^31 weights, not negative, their sum positive.
    explicit PiecewiseConstant(std::span<const double> weight);
    std::uint32_t sample(Uniform u, Uniform& within) const;
    double probability(std::uint32_t i) const { return static_cast<double>(width(i)) * 0x1p-32; }
    std::size_t size() const { return begin_.size(); }

 private:
    std::uint64_t width(std::uint32_t i) const {
        return (i + 1 < begin_.size() ? begin_[i + 1] : std::uint64_t{1} << 32) - begin_[i];
    }
    std::vector<std::uint32_t> begin_;  // where each step begins, in units of 2^-32
};

}  // namespace latent::render
