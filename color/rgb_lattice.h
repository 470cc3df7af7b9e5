// color/rgb_lattice.h: spectra of so many colours that none can be solved for: a picture's. docs/color.md, "RGB to spectrum".
#pragma once

#include <array>
#include <atomic>
#include <mutex>

#include "color/rgb_to_spectrum.h"

namespace latent::color {

// Reflectances of the colours of a lattice in the RGB cube, between which others are interpolated: over the tetrahedron whose edges
// are the greys and the differences of sorted components. Colours are linear in the spectra, so each is met as exactly as those of
// the lattice; greys stay constant; what lies between reflectances is one. A colour of the lattice is solved for when it is first
// needed (40 microseconds). Any thread.
class RgbLattice {
 public:
    explicit RgbLattice(const RgbToSpectrum& rgb) : rgb_(rgb) {}
    static const RgbLattice& srgb();  // under D65

    // The spectrum of `rgb` is the sum of weight[i] (*node[i])(lambda). Components are clamped to [0,1] first.
    struct Blend {
        std::array<const SigmoidSpectrum*, 4> node;
        std::array<float, 4> weight;
    };
    Blend reflectance(float r, float g, float b) const;

 private:
    static constexpr std::size_t kCells = 16, kSide = kCells + 1;

    struct Node {
        std::atomic<bool> is_solved = false;
        SigmoidSpectrum spectrum;
    };
    const SigmoidSpectrum& at(std::size_t index) const;

    RgbToSpectrum rgb_;
    mutable std::mutex solving_;
    mutable std::array<Node, kSide * kSide * kSide> nodes_;  // (r kSide + g) kSide + b
};

}  // namespace latent::color
