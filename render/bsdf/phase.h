// render/bsdf/phase.h: the phase function of Henyey and Greenstein. docs/rendering.md, "Media".
#pragma once

#include "render/math/vec.h"

namespace latent::render {

// Directions point away from the vertex; the same in every wavelength, symmetric, and its own density:
//   p(wo, wi) = (1 - g^2) / (4 pi (1 + g^2 + 2 g cos)^(3/2))  [1/sr],   cos = wo.wi, so that g > 0 favours -1    [HG41]
struct PhaseFunction {
    float g = 0;  // mean cosine of the turn; -1 < g < 1

    float operator()(const Vec3f& wo, const Vec3f& wi) const;
    Vec3f sample(const Vec3f& wo, float u, float v) const;
};

}  // namespace latent::render
