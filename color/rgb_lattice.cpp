#include "color/rgb_lattice.h"

#include <algorithm>

#include "color/named_spectra.h"

namespace latent::color {

RgbLattice::RgbLattice(const RgbToSpectrum& rgb) {
    const auto value = [](int i) { return static_cast<double>(i) / kCells; };
    for (int r = 0; r <= kCells; ++r) {
        for (int g = 0; g <= kCells; ++g) {
            for (int b = 0; b <= kCells; ++b) nodes_.push_back(rgb.reflectance({value(r), value(g), value(b)}));
        }
    }
}

const RgbLattice& RgbLattice::srgb() {
    static const RgbLattice lattice(RgbToSpectrum(RgbSpace::srgb(), illuminant_d65()));
    return lattice;
}

RgbLattice::Blend RgbLattice::reflectance(float r, float g, float b) const {
    constexpr int kStride[3] = {(kCells + 1) * (kCells + 1), kCells + 1, 1};
    int corner = 0;
    std::array<std::pair<float, int>, 3> inside;  // how far along each axis of the cell, and the step along it
    const float rgb[3] = {r, g, b};
    for (std::size_t i = 0; i < 3; ++i) {
        const float x = (rgb[i] > 0 ? std::min(rgb[i], 1.0f) : 0) * kCells;
        const int cell = std::min(static_cast<int>(x), kCells - 1);
        corner += cell * kStride[i];
        inside[i] = {x - static_cast<float>(cell), kStride[i]};
    }
    if (inside[0].first < inside[1].first) std::swap(inside[0], inside[1]);
    if (inside[1].first < inside[2].first) std::swap(inside[1], inside[2]);
    if (inside[0].first < inside[1].first) std::swap(inside[0], inside[1]);
    Blend blend;
    const float upper[5] = {1, inside[0].first, inside[1].first, inside[2].first, 0};
    for (std::size_t i = 0; i < 4; ++i) {
        blend.node[i] = &nodes_[static_cast<std::size_t>(corner)];
        blend.weight[i] = upper[i] - upper[i + 1];
        if (i < 3) corner += inside[i].second;
    }
    return blend;
}

}  // namespace latent::color
