// render/bsdf/receiver.h: how a vertex receives light, for whoever chooses a point of a light for it.
#pragma once

#include "render/math/vec.h"

namespace latent::render {

// What a point of a light is drawn for: an infinite light is drawn by the cosine to the surface that it lights.
struct Receiver {
    Vec3f n;                  // shading normal, on the side that is looked from; 0: in a medium, where all directions are alike
    bool both_sides = false;  // light from behind counts too
};

}  // namespace latent::render
