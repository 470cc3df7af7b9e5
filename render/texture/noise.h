// render/texture/noise.h: gradient noise [Perlin02] and the sums of its octaves that textures are made of.
#pragma once

#include "render/texture/mapping.h"

namespace latent::render {

// Smooth, 0 at points of whole numbers, within [-1, 1].
float noise(const Vec3f& p);

// Sum over i of omega^i noise(1.99^i p): as many of `octaves` as vary more slowly than the footprint, the last one faded in.
float fractal_noise(const SpacePoint& at, float omega, int octaves);
// The same of |noise|; what the footprint hides counts with its mean, 0.2.
float turbulence(const SpacePoint& at, float omega, int octaves);

}  // namespace latent::render
