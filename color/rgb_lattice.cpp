#include "color/rgb_lattice.h"

#include <algorithm>

#include "color/named_spectra.h"

namespace latent::color {

const SigmoidSpectrum& RgbLattice::at(std::size_t index) const {
    Node& node = nodes_[index];
    if (!node.is_solved.load(std::memory_order_acquire)) {
        const std::lock_guard lock(solving_);
        if (!node.is_solved.load(std::memory_order_relaxed)) {
            const auto value = [](std::size_t i) { return static_cast<double>(i % kSide) / kCells; };
            node.spectrum = rgb_.reflectance({value(index / (kSide * kSide)), value(index / kSide), value(index)});
            node.is_solved.store(true, std::memory_order_release);
        }
    }
    return node.spectrum;
}

const RgbLattice& RgbLattice::srgb() {
    static const RgbLattice lattice(RgbToSpectrum(RgbSpace::srgb(), illuminant_d65()));
    return lattice;
}

RgbLattice::Blend RgbLattice::reflectance(float r, float g, float b) const {
    constexpr std::size_t kStride[3] = {kSide * kSide, kSide, 1};
    std::size_t corner = 0;
    std::array<std::pair<float, std::size_t>, 3> inside;  // how far along each axis of the cell, and the step along it
    const float rgb[3] = {r, g, b};
    for (std::size_t i = 0; i < 3; ++i) {
        const float x = (rgb[i] > 0 ? std::min(rgb[i], 1.0f) : 0) * kCells;
        const std::size_t cell = std::min(static_cast<std::size_t>(x), kCells - 1);
        corner += cell * kStride[i];
        inside[i] = {x - static_cast<float>(cell), kStride[i]};
    }
    if (inside[0].first < inside[1].first) std::swap(inside[0], inside[1]);
    if (inside[1].first < inside[2].first) std::swap(inside[1], inside[2]);
    if (inside[0].first < inside[1].first) std::swap(inside[0], inside[1]);
    Blend blend;
    const float upper[5] = {1, inside[0].first, inside[1].first, inside[2].first, 0};
    for (std::size_t i = 0; i < 4; ++i) {
        blend.node[i] = &at(corner);
        blend.weight[i] = upper[i] - upper[i + 1];
        if (i < 3) corner += inside[i].second;
    }
    return blend;
}

}  // namespace latent::color
