// image/convolver.h: pictures of any size whose light spreads by a kernel, in tiles that overlap. Equations: docs/color.md, "Light
// that spreads".
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "image/fourier.h"
#include "image/kernel.h"
#include "image/rect.h"

namespace latent::image {

// Light that would leave the picture stays where it is: an even picture stays even, and no light is lost or gained. Values that are
// not finite, or beyond 1e30, stay where they are and spread nothing. The tiles, and so every bit of the result, depend on kernel
// and picture alone.
class Convolver {
 public:
    static constexpr int kMaxRadius = 1024;  // the largest kernel
    Convolver(const Kernel& kernel, const Rect& picture);

    const Rect& picture() const { return picture_; }
    int size() const { return size_; }                // pixels that a tile sees, along a side
    int margin() const { return radius_; }            // how much of it, at each end, lies outside the tile
    int step() const { return size_ - 2 * radius_; }  // between tiles
    // What it holds, what a tile needs, and the larger need while it is made.
    static std::size_t bytes(int radius, const Rect& picture);

    // What one tile sees, size() * size(), of `usable` values; 0 beyond the picture. `take` gets each channel in turn: what pixels
    // gain from others, right in the tile. The planes hold nothing of use afterwards.
    using Planes = std::array<std::vector<float>, 3>;
    using Take = std::function<void(std::size_t channel, const float* gained)>;
    void spread(Planes& planes, const Take& take) const;
    static float usable(float value) {  // or 0
        constexpr float kMax = 1e30F;
        return value >= -kMax && value <= kMax ? value : 0.0F;
    }

    // Whether anything leaves a pixel, and how much of its light a pixel gives away.
    bool spreads(std::size_t channel) const { return all_[channel] != 0; }
    float given_away(std::size_t channel, int x, int y) const;
    // What pixels x0, x0 + 1, ... of row y have become: what they keep of their light, and gain.
    void join(std::size_t channel, int x0, int y, std::span<const float> light, const float* gained, float* out) const;

 private:
    static int size_for(int radius, const Rect& picture);
    void multiply(std::vector<float>& re, std::vector<float>& im, std::size_t first, std::size_t second) const;

    Rect picture_;
    int radius_, size_;
    SquareFourier fourier_;
    std::array<std::vector<float>, 3>
        spectrum_;  // real; rows as of stored_row() in convolver.cpp; the third: or empty, as nothing spreads
    std::array<std::vector<float>, 3> sums_;  // weights above and to the left, added up
    std::array<float, 3> all_{};              // that a pixel far from the edges gives away
};

}  // namespace latent::image
