// image/kernel.h: where the light of a pixel goes. Equations: docs/color.md, "Light that spreads".
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace latent::image {

// What pixels at most `radius` away, along each axis, get of a pixel's light, in three channels. Symmetric about the centre; what
// is missing from a sum of 1 stays at the centre, whose own weight counts for nothing.
class Kernel {
 public:
    explicit Kernel(int radius);

    int radius() const { return radius_; }
    int side() const { return 2 * radius_ + 1; }
    std::span<float> plane(std::size_t channel) { return weights_[channel]; }
    std::span<const float> plane(std::size_t channel) const { return weights_[channel]; }
    float at(std::size_t channel, int x, int y) const { return weights_[channel][place(x, y)]; }
    void set(std::size_t channel, int x, int y, float weight) { weights_[channel][place(x, y)] = weight; }

 private:
    std::size_t place(int x, int y) const {
        return static_cast<std::size_t>(y + radius_) * static_cast<std::size_t>(side()) + static_cast<std::size_t>(x + radius_);
    }
    int radius_;
    std::array<std::vector<float>, 3> weights_;
};

// A picture of a point of light in square cells: `size * size` of them, a number that is even, with the point in the middle of cell
// size/2, size/2.
struct Pattern {
    int size = 0;
    std::vector<float> light;
};

// Adds light from all places of a pixel to all places of others, `cell` pixels being the width of a cell: each channel gets the
// pattern times its weight. The pattern must reach no farther than `kernel`, or what goes farther stays at the centre.
void add_pattern(const Pattern& pattern, double cell, const std::array<float, 3>& weights, Kernel& kernel);

// First the one, then the other.
Kernel in_turn(const Kernel& first, const Kernel& second);

}  // namespace latent::image
