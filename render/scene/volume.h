// render/scene/volume.h: how the density of a medium varies in space, as a scene gives it. docs/rendering.md, "Media".
#pragma once

#include <cstdint>
#include <memory>
#include <variant>

#include "render/math/vec.h"
#include "render/scene/voxel_grid.h"

namespace latent::render {

// The same everywhere, without end.
struct UniformVolume {};

// A grid in the space of its voxels: the value of voxel (i, j, k) is met at the point (i, j, k).
struct GridVolume {
    std::shared_ptr<const VoxelGrid> density{};
    Affined density_from_medium{};
};

using Volume = std::variant<UniformVolume, GridVolume>;

}  // namespace latent::render
