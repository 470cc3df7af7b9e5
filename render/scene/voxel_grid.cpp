#include "render/scene/voxel_grid.h"

#include <algorithm>
#include <cmath>

namespace latent::render {

namespace {

// The whole points whose values count between low and high, those that exist.
struct Range {
    std::int32_t first, last;
};
Range points_about(float low, float high, std::uint32_t size) {
    const float end = static_cast<float>(size);
    return {static_cast<std::int32_t>(std::clamp(std::floor(low), 0.0f, end)),
            static_cast<std::int32_t>(std::clamp(std::floor(high) + 1, -1.0f, end - 1))};
}

}  // namespace

VoxelGrid VoxelGrid::of_size(const std::array<std::uint32_t, 3>& size) {
    VoxelGrid grid{.size = size};
    grid.brick.assign(std::size_t{bricks_along(size[0])} * bricks_along(size[1]) * bricks_along(size[2]), kEmpty);
    return grid;
}

float* VoxelGrid::make_brick(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    std::uint32_t& b = brick[brick_index(i, j, k)];
    if (b == kEmpty) {
        b = static_cast<std::uint32_t>(values.size() / kBrick);
        values.resize(values.size() + kBrick);
    }
    return values.data() + std::size_t{b} * kBrick;
}

void VoxelGrid::set(std::uint32_t i, std::uint32_t j, std::uint32_t k, float value) {
    if (value == 0 && brick[brick_index(i, j, k)] == kEmpty) return;
    make_brick(i, j, k)[offset(i, j, k)] = value;
}

void VoxelGrid::fill_brick(std::uint32_t i, std::uint32_t j, std::uint32_t k, float value) {
    const std::size_t count = values.size();
    const bool again = count > 0 && std::all_of(values.end() - kBrick, values.end(), [&](float v) { return v == value; });
    if (!again) values.resize(count + kBrick, value);
    brick[brick_index(i, j, k)] = static_cast<std::uint32_t>(values.size() / kBrick - 1);
}

float VoxelGrid::operator()(const Vec3f& p) const {
    // Far outside everything is zero, and stays within what an integer holds.
    const auto cell = [](float x) { return std::floor(std::clamp(x, -2.0f, 0x1p30f)); };
    const Vec3f low{cell(p.x), cell(p.y), cell(p.z)}, f = p - low;
    const auto i = static_cast<std::int32_t>(low.x), j = static_cast<std::int32_t>(low.y), k = static_cast<std::int32_t>(low.z);
    float v[8];
    const auto ui = static_cast<std::uint32_t>(i), uj = static_cast<std::uint32_t>(j), uk = static_cast<std::uint32_t>(k);
    const bool inside = ui + 1 < size[0] && uj + 1 < size[1] && uk + 1 < size[2] && i >= 0 && j >= 0 && k >= 0;
    if (inside && ui % kEdge != kEdge - 1 && uj % kEdge != kEdge - 1 && uk % kEdge != kEdge - 1) {
        const std::uint32_t b = brick[brick_index(ui, uj, uk)];
        if (b == kEmpty) return 0;
        const float* const first = values.data() + std::size_t{b} * kBrick + offset(ui, uj, uk);
        for (std::uint32_t n = 0; n < 8; ++n) v[n] = first[(n & 1) + kEdge * ((n >> 1 & 1) + kEdge * (n >> 2))];
    } else {
        for (std::int32_t n = 0; n < 8; ++n) v[n] = at(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2));
    }
    const auto mix = [](float t, float a, float b) { return (1 - t) * a + t * b; };
    return mix(f.z, mix(f.y, mix(f.x, v[0], v[1]), mix(f.x, v[2], v[3])), mix(f.y, mix(f.x, v[4], v[5]), mix(f.x, v[6], v[7])));
}

float VoxelGrid::min_value() const { return values.empty() ? 0 : std::min(0.0f, *std::min_element(values.begin(), values.end())); }

float VoxelGrid::max_between(const Vec3f& low, const Vec3f& high) const {
    const Range x = points_about(low.x, high.x, size[0]), y = points_about(low.y, high.y, size[1]),
                z = points_about(low.z, high.z, size[2]);
    float most = 0;
    for (std::int32_t k = z.first; k <= z.last; ++k) {
        for (std::int32_t j = y.first; j <= y.last; ++j) {
            for (std::int32_t i = x.first; i <= x.last; ++i) most = std::max(most, at(i, j, k));
        }
    }
    return most;
}

}  // namespace latent::render
