// render/geometry/emitters.h: the primitives of area lights, found among the shapes of the world.
#pragma once

#include "render/geometry/placed_shape.h"

namespace latent::render {

// Sets each shape's first_emitter. Errors: kUnsupported: what render/scene/check.h refuses.
Result<std::vector<Emitter>> find_emitters(std::vector<PlacedShape>& shapes);

}  // namespace latent::render
