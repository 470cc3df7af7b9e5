#include "render/medium/majorant_grid.h"

namespace latent::render {

MajorantGrid::Size MajorantGrid::size_for(const Size& voxels) {
    Size size;
    for (int a = 0; a < 3; ++a) size[a] = std::min(voxels[a], std::clamp((voxels[a] + 3) / 4, 16u, 64u));
    return size;
}

MajorantGrid::MajorantGrid(const Size& size, const std::function<float(const Vec3f&, const Vec3f&)>& max_between,
                           const std::function<float(const Vec3f&)>& at)
    : size_(size), cells_(std::size_t{size[0]} * size[1] * size[2]) {
    constexpr std::uint32_t kPoints = 3;  // along each axis, for the mean
    const Vec3f edge{1 / static_cast<float>(size[0]), 1 / static_cast<float>(size[1]), 1 / static_cast<float>(size[2])};
    const auto point = [&](float x, float y, float z) { return Vec3f{x * edge.x, y * edge.y, z * edge.z}; };
    for (std::size_t index = 0; index < cells_.size(); ++index) {
        const std::size_t row = index / size[0], layer = row / size[1];
        const float x = static_cast<float>(index % size[0]), y = static_cast<float>(row % size[1]), z = static_cast<float>(layer);
        Cell& cell = cells_[index];
        // A little larger, as rounding may put a point just outside of its cell.
        constexpr float kMargin = 1e-3f;
        cell.max =
            max_between(point(x - kMargin, y - kMargin, z - kMargin), point(x + 1 + kMargin, y + 1 + kMargin, z + 1 + kMargin));
        cell.mean = 0;
        if (cell.max == 0) continue;
        for (std::uint32_t n = 0; n < kPoints * kPoints * kPoints; ++n) {
            const auto inner = [](std::uint32_t i) { return (static_cast<float>(i) + 0.5f) / kPoints; };
            cell.mean += at(point(x + inner(n % kPoints), y + inner(n / kPoints % kPoints), z + inner(n / kPoints / kPoints)));
        }
        cell.mean /= kPoints * kPoints * kPoints;
    }
}

}  // namespace latent::render
