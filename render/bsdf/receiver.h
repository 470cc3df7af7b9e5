// render/bsdf/receiver.h: how a vertex receives light, for whoever chooses a point of a light or of the sky for it.
#pragma once

#include "render/math/vec.h"

namespace latent::render {

// What a point of a light is drawn for: the sky is drawn by the cosine to the surface that it will light.
struct Receiver {
    Vec3f n;                  // shading normal, on the side that is looked from; 0: in a medium, where all directions are alike
    bool both_sides = false;  // light from behind counts too
};

}  // namespace latent::render
