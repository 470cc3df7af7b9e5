// render/bsdf/light_sample_context.h: the vertex that a point of a light is sampled for.
#pragma once

#include "render/math/vec.h"

namespace latent::render {

// An infinite light is drawn by the cosine to the surface that it lights.
struct LightSampleContext {
    Vec3f n;                  // shading normal, on the side that is looked from; 0: in a medium, where all directions are alike
    bool both_sides = false;  // light from behind counts too
};

}  // namespace latent::render
