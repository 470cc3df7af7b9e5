// render/load/volume/nanovdb.h: grids of NanoVDB files, version 32, uncompressed or zipped. docs/scenes.md, "Media".
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "base/result.h"
#include "render/scene/voxel_grid.h"

namespace latent::render {

struct LoadedVolume {
    std::shared_ptr<const VoxelGrid> grid;
    Affined grid_from_medium;  // NanoVDB's world is the space of the medium
    Vec3d low, high;           // about all active voxels, in the space of the medium
};

// The grid of this name in a file's bytes, every value of which must be finite. Nothing in the file is trusted: what points outside
// of it, or asks for more room than it could fill, is refused.
// Errors: kNotFound: no such grid; kForeign, kTruncated, kCorrupt; kUnsupported: other versions, compressions and types of values.
Result<LoadedVolume> read_nanovdb(std::span<const std::byte> file, std::string_view name);

}  // namespace latent::render
