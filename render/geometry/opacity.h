// render/geometry/opacity.h: how much of a surface is there, where a texture says so.
#pragma once

#include "render/geometry/geometry.h"

namespace latent::render {

// Any thread.
class Opacity {
 public:
    virtual ~Opacity() = default;
    // The value of an `alpha` that is a texture.
    virtual float at(const FloatInput& alpha, const SurfaceHit& hit, const SurfaceCoordinates& coordinates) const = 0;
};

}  // namespace latent::render
