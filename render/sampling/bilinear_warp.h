// render/sampling/bilinear_warp.h: densities over the unit square that are linear between the points of a lattice, and mixtures of
// them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/math/vec.h"

namespace latent::render {

// The points of a lattice over the unit square, row after row, that a place lies between.
struct LatticeCell {
    std::array<std::size_t, 4> corner;
    std::array<float, 4> share;
};
LatticeCell lattice_cell(std::uint32_t width, std::uint32_t height, const Vec2f& place);
// The value there.
float bilinear(std::span<const float> values, std::uint32_t width, std::uint32_t height, const Vec2f& place);

// Which of the densities, in shares that add up to 1.
struct TableMixture {
    std::array<std::uint32_t, 4> table{};
    std::array<float, 4> share{1, 0, 0, 0};
};

class BilinearWarp {
 public:
    // `values`: width x height for each density, which is proportional to them; finite, not negative. A table of zeros is uniform.
    BilinearWarp(std::span<const float> values, std::uint32_t width, std::uint32_t height);

    // A place that follows the density for uniform (u, v), first its row: u is about x, v about y. And back.
    Vec2f sample(const TableMixture& mixture, float u, float v) const;
    Vec2f invert(const TableMixture& mixture, const Vec2f& place) const;
    float density(const TableMixture& mixture, const Vec2f& place) const;

 private:
    static float mixed(const std::vector<float>& values, std::size_t of_table, std::size_t i, const TableMixture& mixture) {
        float sum = 0;
        for (std::size_t t = 0; t < 4; ++t) {
            if (mixture.share[t] != 0) sum += mixture.share[t] * values[mixture.table[t] * of_table + i];
        }
        return sum;
    }
    float value(const TableMixture& m, std::uint32_t x, std::uint32_t y) const {
        return mixed(values_, std::size_t{width_} * height_, std::size_t{y} * width_ + x, m);
    }
    // The integral over a row up to a point, and over [0,1] x [0, y].
    float in_row(const TableMixture& m, std::uint32_t x, std::uint32_t y) const {
        return mixed(in_row_, std::size_t{width_} * height_, std::size_t{y} * width_ + x, m);
    }
    float below(const TableMixture& m, std::uint32_t y) const { return mixed(below_, height_, y, m); }
    float row(const TableMixture& m, std::uint32_t y) const { return in_row(m, width_ - 1, y); }

    std::uint32_t width_, height_;
    std::vector<float> values_, in_row_, below_;
};

}  // namespace latent::render
