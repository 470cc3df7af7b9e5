// render/medium/majorant_grid.h: the greatest and the mean density of a medium in each cell of a coarse grid over it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "render/math/vec.h"

namespace latent::render {

// Cells share the unit cube evenly; outside it the density is zero.
class MajorantGrid {
 public:
    struct Cell {
        float max, mean;
    };
    using Size = std::array<std::uint32_t, 3>;

    // One cell for each voxel of small grids, coarser for large ones: what passes a cell in which nothing is should cost little.
    static Size size_for(const Size& voxels);

    // `max_between` (low, high) bounds the density in a box of the unit cube; `at` is the density at a point.
    MajorantGrid(const Size& size, const std::function<float(const Vec3f&, const Vec3f&)>& max_between,
                 const std::function<float(const Vec3f&)>& at);

    // The greatest density of the cells that a box touches; the mean density of the cell of a point. 0 outside of the cube.
    float max_between(const Vec3f& low, const Vec3f& high) const;
    float mean_at(const Vec3f& p) const;
    // The greatest density of all, and how many cells there are along each axis.
    float max() const;
    const Size& size() const { return size_; }

    // Calls visit(t0, t1, cell) for the cells that the line o + t d, 0 <= t < end, passes through, in this order, as long as it
    // returns true.
    template <class Visit>
    void traverse(const Vec3f& o, const Vec3f& d, float end, Visit visit) const;

 private:
    Size size_;
    std::vector<Cell> cells_;  // x first
};

template <class Visit>
void MajorantGrid::traverse(const Vec3f& o, const Vec3f& d, float end, Visit visit) const {
    const float origin[3] = {o.x, o.y, o.z}, direction[3] = {d.x, d.y, d.z};
    float t = 0;
    for (int a = 0; a < 3; ++a) {
        if (direction[a] == 0) {
            if (!(origin[a] >= 0 && origin[a] <= 1)) return;
            continue;
        }
        const float t0 = -origin[a] / direction[a], t1 = (1 - origin[a]) / direction[a];
        t = std::max(t, std::min(t0, t1));
        end = std::min(end, std::max(t0, t1));
    }
    if (!(t < end)) return;
    float next[3], step_t[3];  // where the line leaves the cell along each axis, and how far it is through a cell
    std::int64_t left[3];      // cells to come along each axis
    std::int64_t stride[3] = {1, size_[0], std::int64_t{size_[0]} * size_[1]};
    const Cell* cell = cells_.data();
    for (int a = 0; a < 3; ++a) {
        const float n = static_cast<float>(size_[a]);
        const float at = std::clamp((origin[a] + direction[a] * t) * n, 0.0f, n - 1);
        const auto first = static_cast<std::int64_t>(at);
        cell += first * stride[a];
        left[a] = direction[a] > 0 ? std::int64_t{size_[a]} - 1 - first : first;
        step_t[a] = direction[a] == 0 ? kInfinity : 1 / std::abs(direction[a] * n);
        const float face = static_cast<float>(first + (direction[a] > 0)) / n;
        next[a] = direction[a] == 0 ? kInfinity : (face - origin[a]) / direction[a];
        if (!(direction[a] > 0)) stride[a] = -stride[a];
    }
    while (true) {
        // Which axis comes next is hard to foresee: arithmetic, not branches.
        const bool second = next[1] < next[0];
        const float nearer = second ? next[1] : next[0];
        const std::size_t a = next[2] < nearer ? 2 : std::size_t{second};
        const float face = std::min(nearer, next[2]), leave = std::min(face, end);
        if (leave > t) {
            if (!visit(t, leave, *cell)) return;
            t = leave;
        }
        if (!(face < end) || left[a] == 0) return;
        --left[a];
        cell += stride[a];
        next[a] += step_t[a];
    }
}

}  // namespace latent::render
