// render/world/texture_point.h: the point of a surface that textures are evaluated at.
#pragma once

#include "render/geometry/geometry.h"
#include "render/texture/footprint.h"
#include "render/texture/texture.h"

namespace latent::render {

// All of `point` but its spectra.
void fill_in(const SurfaceHit& hit, const SurfaceCoordinates& coordinates, const Footprint& footprint, TexturePoint& point);

}  // namespace latent::render
