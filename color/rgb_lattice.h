// color/rgb_lattice.h: spectra of so many colours that none can be solved for: a picture's. docs/color.md, "RGB to spectrum".
#pragma once

#include <array>
#include <vector>

#include "color/rgb_to_spectrum.h"

namespace latent::color {

// Reflectances of the colours of a lattice in the RGB cube, between which others are interpolated: over the tetrahedron whose edges
// are the greys and the differences of sorted components. Colours are linear in the spectra, so each is met as exactly as those of
// the lattice; greys stay constant; what lies between reflectances is one.
class RgbLattice {
 public:
    explicit RgbLattice(const RgbToSpectrum& rgb);
    static const RgbLattice& srgb();  // under D65; made at the first call, in 0.2 s

    // The spectrum of `rgb` is the sum of weight[i] (*node[i])(lambda). Components are clamped to [0,1] first.
    struct Blend {
        std::array<const SigmoidSpectrum*, 4> node;
        std::array<float, 4> weight;
    };
    Blend reflectance(float r, float g, float b) const;

 private:
    static constexpr int kCells = 16;
    std::vector<SigmoidSpectrum> nodes_;  // (r (kCells + 1) + g) (kCells + 1) + b
};

}  // namespace latent::color
