// render/scene/volume.h: how a medium varies in space, as a scene gives it. docs/rendering.md, "Media".
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "render/math/vec.h"
#include "render/scene/voxel_grid.h"

namespace latent::render {

// The same everywhere, without end.
struct UniformVolume {};

// A grid about some part of a medium, which maps the space of the medium to that of its voxels: (i, j, k) is where voxel
// (i, j, k) has its value.
struct PlacedGrid {
    std::shared_ptr<const VoxelGrid> grid{};
    Affined grid_from_medium{};
};

// Densities that scale the spectra of the medium.
struct GridVolume {
    PlacedGrid density{};
    // Kelvin. Where there is one, matter that absorbs is a black body of (T - offset) scale, if that is above 100 K: its radiance
    // has the peak 1 over wavelengths, and replaces the spectrum Le.
    PlacedGrid temperature{};
    double temperature_offset = 0, temperature_scale = 1;
    PlacedGrid Le_scale{};  // factor of the emission; none: 1
};

// Spectra of voxels that share a box evenly, x first: c0 c1 c2 and scale of a color::SigmoidSpectrum each, or r g b and 1 of what
// color::rgb_basis_spectrum makes of them.
struct SpectralVoxels {
    std::array<std::uint32_t, 3> size{};
    std::vector<std::array<float, 4>> spectra{};
    bool is_basis = false;
};

// sigma_a and sigma_s [1/m], and the spectrum that multiplies Le; null: 1 everywhere, or for Le no emission.
struct SpectralVolume {
    std::shared_ptr<const SpectralVoxels> sigma_a{}, sigma_s{}, Le{};
};

// pbrt-v4's cloud of noise; y is up, and its base is at 0.5.
struct CloudVolume {
    double density = 1, wispiness = 1, frequency = 5;
};

using Volume = std::variant<UniformVolume, GridVolume, SpectralVolume, CloudVolume>;

}  // namespace latent::render
