#include "render/load/pbrt/media.h"

#include <fmt/format.h>

#include <map>

#include "color/observer.h"
#include "render/load/pbrt/features.h"
#include "render/load/pbrt/measured_media.h"
#include "render/load/volume/nanovdb.h"

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

// False: an error was reported.
bool has_value_for_each_voxel(const ParameterList& list, std::string_view name, const GridSize& size, std::size_t count) {
    if (count == size.count()) return true;
    list.error(fmt::format("{}: {} values, but nx ny nz is {}", name, count, size.count()));
    return false;
}

// Values of voxels, x first, none below `low`. Null: an error was reported.
std::shared_ptr<const VoxelGrid> read_voxels(const ParameterList& list, std::string_view name, const GridSize& size, double low) {
    const std::span<const double> values = list.array(name, "float", 1);
    if (!has_value_for_each_voxel(list, name, size, values.size())) return nullptr;
    VoxelGrid grid = VoxelGrid::of_size(size.voxels);
    const auto [nx, ny, nz] = size.voxels;
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (!(values[n] >= low && values[n] <= 1e30)) {
            list.error(fmt::format("{}: value {} is {}, which is not between {} and 1e30", name, n + 1, values[n], low));
            return nullptr;
        }
        grid.set(static_cast<std::uint32_t>(n % nx), static_cast<std::uint32_t>(n / nx % ny),
                 static_cast<std::uint32_t>(n / nx / ny), static_cast<float>(values[n]));
    }
    return std::make_shared<const VoxelGrid>(std::move(grid));
}

// Spectra of voxels. Null: there is no such parameter, or an error was reported.
std::shared_ptr<const SpectralVoxels> read_spectra(const ParameterList& list, std::string_view name, const GridSize& size,
                                                   SceneSpectra& spectra) {
    const std::span<const double> values = list.array(name, "rgb", 3);
    if (values.empty() || !has_value_for_each_voxel(list, name, size, values.size() / 3)) return nullptr;
    SpectralVoxels voxels{.size = size.voxels, .is_basis = spectra.is_basis()};
    std::map<std::array<double, 3>, std::array<float, 4>> known;  // each colour takes its time
    for (std::size_t n = 0; n < values.size(); n += 3) {
        const std::array<double, 3> colour = {values[n], values[n + 1], values[n + 2]};
        for (const double component : colour) {
            if (component >= 0 && component <= 1e30) continue;
            list.error(fmt::format("{}: colour {} has {}, which is not between 0 and 1e30", name, n / 3 + 1, component));
            return nullptr;
        }
        const auto [found, is_new] = known.try_emplace(colour);
        if (is_new) found->second = spectra.voxel_of({colour[0], colour[1], colour[2]});
        voxels.spectra.push_back(found->second);
    }
    return std::make_shared<const SpectralVoxels>(std::move(voxels));
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

// Le and its scale, a number.
void read_emission(const ParameterList& list, SceneSpectra& spectra, MediumDescription& medium) {
    if (SceneSpectra::is_given(list, "Le")) medium.Le = spectra.emission(list, "Le");
    medium.Le_scale = list.number("Lescale", 1, 0, 1e12);
}

void read_temperature(const ParameterList& list, GridVolume& volume) {
    volume.temperature_offset = list.number("temperatureoffset", list.number("temperaturecutoff", 0));
    volume.temperature_scale = list.number("temperaturescale", 1);
}

void read_uniform_grid(const ParameterList& list, SceneSpectra& spectra, MediumDescription& medium) {
    read_box(list, medium);
    const GridSize size = read_grid_size(list);
    const Affined grid_from_medium = voxels_from_box(size, medium.low, medium.high);
    GridVolume volume;
    volume.density = {read_voxels(list, "density", size, 0), grid_from_medium};
    if (list.find("temperature", {"float"}) != nullptr) {
        volume.temperature = {read_voxels(list, "temperature", size, -1e30), grid_from_medium};
        read_temperature(list, volume);
    }
    if (SceneSpectra::is_given(list, "Le")) {
        if (volume.temperature.grid) list.error("Le and temperature cannot be combined");
        medium.Le = spectra.emission(list, "Le");
    }
    if (list.find("Lescale", {"float"}) != nullptr) volume.Le_scale = {read_voxels(list, "Lescale", size, 0), grid_from_medium};
    if (volume.density.grid) medium.volume = std::move(volume);
}

void read_rgb_grid(const ParameterList& list, SceneSpectra& spectra, MediumDescription& medium) {
    read_box(list, medium);
    const GridSize size = read_grid_size(list);
    const SpectralVolume volume{read_spectra(list, "sigma_a", size, spectra), read_spectra(list, "sigma_s", size, spectra),
                                read_spectra(list, "Le", size, spectra)};
    if (!volume.sigma_a && !volume.sigma_s) return list.error("sigma_a and sigma_s: one of them is required");
    if (volume.Le && !volume.sigma_a) return list.error("Le: needs sigma_a");
    // pbrt-v4 does not normalise this emission: white has the luminance of its illuminant, the integral of ybar.
    double y = 0;
    for (double nm = color::kLambdaMin; nm <= color::kLambdaMax; ++nm) y += color::Observer::cie1931().at(nm)[1];
    medium.Le = spectra.white().scaled(y);
    medium.Le_scale = list.number("Lescale", 1, 0, 1e12);
    medium.volume = volume;
}

void read_cloud(const ParameterList& list, MediumDescription& medium) {
    read_box(list, medium);
    medium.volume = CloudVolume{.density = list.number("density", 1, 0, 1e6),
                                .wispiness = list.number("wispiness", 1, 0, 1e3),
                                .frequency = list.number("frequency", 5, -1e6, 1e6)};
}

void read_nanovdb_grids(const ParameterList& list, const SceneFiles& files, MediumDescription& medium) {
    const std::optional<std::string> name = list.string("filename");
    const std::string density = list.string("gridname").value_or("density"),
                      temperature = list.string("temperaturename").value_or("temperature");
    GridVolume volume;
    medium.Le_scale = list.number("Lescale", 1, 0, 1e12);
    read_temperature(list, volume);
    if (!name) return list.error("filename: is required");
    const Result<std::string> bytes = files.read(*name);
    if (!bytes) return list.unreadable(bytes.error());
    const auto file = std::as_bytes(std::span(*bytes));
    const Result<LoadedVolume> loaded = read_nanovdb(file, density);
    if (!loaded) return list.error(fmt::format("{}: {}", *name, loaded.error().message));
    if (loaded->grid->min_value() < 0) return list.error(fmt::format("{}: grid \"{}\" has negative densities", *name, density));
    volume.density = {loaded->grid, loaded->grid_from_medium};
    medium.low = loaded->low;
    medium.high = loaded->high;
    const Result<LoadedVolume> warm = read_nanovdb(file, temperature);
    if (warm) volume.temperature = {warm->grid, warm->grid_from_medium};
    if (!warm && warm.error().code != ErrorCode::kNotFound) return list.error(fmt::format("{}: {}", *name, warm.error().message));
    medium.volume = std::move(volume);
}

}  // namespace

MediumDescription read_medium(const std::string& type, const ParameterList& list, const Affined& world_from_medium,
                              SceneSpectra& spectra, const SceneFiles& files) {
    MediumDescription medium{.location = list.directive().where};
    const std::optional<std::string> preset = list.string("preset");
    if (preset && type != "rgbgrid") {
        const std::optional<MeasuredMedium> known = measured_medium(*preset);
        if (!known) list.error(fmt::format("preset: \"{}\" is not one of {}", *preset, measured_media()));
        if (known) medium.sigma_a = known->sigma_a, medium.sigma_s = known->sigma_s;
    } else if (type != "rgbgrid") {
        medium.sigma_a = spectra.find(list, "sigma_a", SpectrumRole::kUnbounded).value_or(color::Spectrum::constant(1));
        medium.sigma_s = spectra.find(list, "sigma_s", SpectrumRole::kUnbounded).value_or(color::Spectrum::constant(1));
    }
    medium.g = list.number("g", 0, -0.9999, 0.9999);
    if (type != "cloud") medium.scale = list.number("scale", 1, 0, 1e12);
    if (type == "homogeneous") {
        read_emission(list, spectra, medium);
    } else {
        medium.world_from_medium = world_from_medium;
        if (!world_from_medium.inverse()) list.error("MakeNamedMedium: the transformation is singular");
        if (type == "uniformgrid") {
            read_uniform_grid(list, spectra, medium);
        } else if (type == "rgbgrid") {
            read_rgb_grid(list, spectra, medium);
        } else if (type == "cloud") {
            read_cloud(list, medium);
        } else if (type == "nanovdb") {
            read_nanovdb_grids(list, files, medium);
        } else {
            list.error(unsupported("Medium", type));
            return medium;
        }
    }
    list.report_unused();
    return medium;
}

}  // namespace latent::render
