// render/scene/shape_counts.h: how much geometry a scene has.
#pragma once

#include <cstdint>

#include "render/scene/description.h"

namespace latent::render {

struct ShapeCounts {
    std::uint64_t triangles = 0, patches = 0;  // patches: bilinear, curved; a flat parallelogram is two triangles
    std::uint64_t curve_segments = 0;          // in all tubes
    std::uint64_t quadrics = 0;                // spheres, disks and cylinders, or parts of them

    bool operator==(const ShapeCounts&) const = default;
};

struct SceneSize {
    ShapeCounts stored;  // in memory, those of an object once
    ShapeCounts placed;  // in the world: those of an object once for each instance
    std::uint64_t instances = 0;
};
SceneSize size_of(const SceneDescription& scene);

}  // namespace latent::render
