// render/scene/voxel_grid.h: values at the points of a lattice, in bricks: what is zero takes no room.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/math/vec.h"

namespace latent::render {

// Linear between the points (i, j, k), 0 <= i < size[0] and so on, and zero at all others.
struct VoxelGrid {
    static constexpr std::uint32_t kEdge = 8, kBrick = kEdge * kEdge * kEdge;  // voxels of a brick
    static constexpr std::uint32_t kEmpty = 0xFFFFFFFF;

    std::array<std::uint32_t, 3> size{};
    std::vector<std::uint32_t> brick{};  // x first: which one of `values`, or kEmpty
    std::vector<float> values{};         // kBrick each, x first

    // All zero. The product of the sizes is below 2^40.
    static VoxelGrid of_size(const std::array<std::uint32_t, 3>& size);
    static std::uint32_t bricks_along(std::uint32_t voxels) { return (voxels + kEdge - 1) / kEdge; }

    // Room for the brick that holds a voxel, zero at first.
    float* make_brick(std::uint32_t i, std::uint32_t j, std::uint32_t k);
    void set(std::uint32_t i, std::uint32_t j, std::uint32_t k, float value);
    // All voxels of the brick; it takes the room of the last one that was filled with the same value.
    void fill_brick(std::uint32_t i, std::uint32_t j, std::uint32_t k, float value);

    float at(std::int32_t i, std::int32_t j, std::int32_t k) const {
        const auto x = static_cast<std::uint32_t>(i), y = static_cast<std::uint32_t>(j), z = static_cast<std::uint32_t>(k);
        if (x >= size[0] || y >= size[1] || z >= size[2]) return 0;
        const std::uint32_t b = brick[brick_index(x, y, z)];
        return b == kEmpty ? 0 : values[std::size_t{b} * kBrick + offset(x, y, z)];
    }
    float operator()(const Vec3f& p) const;
    float min_value() const;
    // The greatest value at a point of the box between two points.
    float max_between(const Vec3f& low, const Vec3f& high) const;

 private:
    static std::uint32_t offset(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
        return (x % kEdge) + kEdge * ((y % kEdge) + kEdge * (z % kEdge));
    }
    std::size_t brick_index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
        return x / kEdge + std::size_t{bricks_along(size[0])} * (y / kEdge + std::size_t{bricks_along(size[1])} * (z / kEdge));
    }
};

}  // namespace latent::render
