// render/geometry/opacity.h: the opacity of a surface, as its texture gives it.
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
