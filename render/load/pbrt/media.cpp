#include "render/load/pbrt/media.h"

#include <fmt/format.h>

namespace latent::render {

namespace {

struct GridSize {
    std::array<std::uint32_t, 3> voxels;
    std::size_t count() const { return std::size_t{voxels[0]} * voxels[1] * voxels[2]; }
};

GridSize read_grid_size(const ParameterList& list) {
    const auto along = [&](const char* name) { return static_cast<std::uint32_t>(list.integer(name, 1, 1, 1 << 13)); };
    return {{along("nx"), along("ny"), along("nz")}};
}

// Values of voxels, x first: as many as the grid has, finite and not negative. Null: an error was reported.
std::shared_ptr<const VoxelGrid> read_voxels(const ParameterList& list, std::string_view name, const GridSize& size) {
    const std::span<const double> values = list.array(name, "float", 1);
    if (values.size() != size.count()) {
        list.error(fmt::format("{}: {} values, but nx ny nz is {}", name, values.size(), size.count()));
        return nullptr;
    }
    VoxelGrid grid = VoxelGrid::of_size(size.voxels);
    const auto [nx, ny, nz] = size.voxels;
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (!(values[n] >= 0 && values[n] <= 1e30)) {
            list.error(fmt::format("{}: value {} is {}; densities must not be negative", name, n + 1, values[n]));
            return nullptr;
        }
        grid.set(static_cast<std::uint32_t>(n % nx), static_cast<std::uint32_t>(n / nx % ny),
                 static_cast<std::uint32_t>(n / nx / ny), static_cast<float>(values[n]));
    }
    return std::make_shared<const VoxelGrid>(std::move(grid));
}

// Voxels share the box evenly, and have their values at their middles.
Affined voxels_from_box(const GridSize& size, const Vec3d& low, const Vec3d& high) {
    const Vec3d edge = high - low;
    const auto along = [](std::uint32_t n, double length) { return static_cast<double>(n) / length; };
    const Vec3d scale{along(size.voxels[0], edge.x), along(size.voxels[1], edge.y), along(size.voxels[2], edge.z)};
    return {{scale.x, 0, 0},
            {0, scale.y, 0},
            {0, 0, scale.z},
            {-low.x * scale.x - 0.5, -low.y * scale.y - 0.5, -low.z * scale.z - 0.5}};
}

// p0 and p1 are opposite corners.
void read_box(const ParameterList& list, MediumDescription& medium) {
    const Vec3d a = list.point("p0", {0, 0, 0}), b = list.point("p1", {1, 1, 1});
    medium.low = {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
    medium.high = {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
    const Vec3d size = medium.high - medium.low;
    if (!(size.x > 0 && size.y > 0 && size.z > 0)) list.error("p0 and p1: the box between them is flat");
}

}  // namespace

MediumDescription read_medium(const std::string& type, const ParameterList& list, const Affined& world_from_medium,
                              SceneSpectra& spectra) {
    MediumDescription medium{.location = list.directive().where};
    if (type != "homogeneous" && type != "uniformgrid") {
        list.error(fmt::format("Medium \"{}\" is not supported (homogeneous, uniformgrid)", type));
        return medium;
    }
    const auto sigma_a = spectra.find(list, "sigma_a", SpectrumRole::kUnbounded),
               sigma_s = spectra.find(list, "sigma_s", SpectrumRole::kUnbounded);
    if (list.string("preset")) list.error("preset: is not supported; give sigma_a and sigma_s");
    medium.sigma_a = sigma_a.value_or(color::Spectrum::constant(1));
    medium.sigma_s = sigma_s.value_or(color::Spectrum::constant(1));
    medium.scale = list.number("scale", 1, 0, 1e12);
    medium.g = list.number("g", 0, -0.9999, 0.9999);
    if (type == "homogeneous") {
        list.report_unused();
        return medium;
    }
    medium.world_from_medium = world_from_medium;
    if (!world_from_medium.inverse()) list.error("MakeNamedMedium: the transformation is singular");
    read_box(list, medium);
    const GridSize size = read_grid_size(list);
    GridVolume volume{.density_from_medium = voxels_from_box(size, medium.low, medium.high)};
    volume.density = read_voxels(list, "density", size);
    if (volume.density) medium.volume = std::move(volume);
    list.report_unused();
    return medium;
}

}  // namespace latent::render
