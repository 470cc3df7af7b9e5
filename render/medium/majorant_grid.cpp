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

float MajorantGrid::max_between(const Vec3f& low, const Vec3f& high) const {
    const float from[3] = {low.x, low.y, low.z}, to[3] = {high.x, high.y, high.z};
    std::uint32_t first[3], last[3];
    for (int a = 0; a < 3; ++a) {
        if (!(from[a] <= 1 && to[a] >= 0)) return 0;
        const float n = static_cast<float>(size_[a]);
        first[a] = static_cast<std::uint32_t>(std::clamp(from[a] * n, 0.0f, n - 1));
        last[a] = static_cast<std::uint32_t>(std::clamp(to[a] * n, 0.0f, n - 1));
    }
    float most = 0;
    for (std::uint32_t z = first[2]; z <= last[2]; ++z) {
        for (std::uint32_t y = first[1]; y <= last[1]; ++y) {
            const std::size_t row = (std::size_t{z} * size_[1] + y) * size_[0];
            for (std::uint32_t x = first[0]; x <= last[0]; ++x) most = std::max(most, cells_[row + x].max);
        }
    }
    return most;
}

float MajorantGrid::max() const { return std::ranges::max_element(cells_, {}, &Cell::max)->max; }

float MajorantGrid::mean_at(const Vec3f& p) const {
    const float at[3] = {p.x, p.y, p.z};
    std::size_t index = 0;
    for (int a = 2; a >= 0; --a) {
        if (!(at[a] >= 0 && at[a] <= 1)) return 0;
        const float n = static_cast<float>(size_[a]);
        index = index * size_[a] + static_cast<std::size_t>(std::min(at[a] * n, n - 1));
    }
    return cells_[index].mean;
}

}  // namespace latent::render
