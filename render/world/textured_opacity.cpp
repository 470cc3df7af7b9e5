#include "render/world/textured_opacity.h"

#include "render/world/texture_point.h"

namespace latent::render {

float TexturedOpacity::at(const FloatInput& alpha, const SurfaceHit& hit, const SurfaceCoordinates& coordinates) const {
    TexturePoint point;
    fill_in(hit, coordinates, footprint_, point);
    return textures_.source(alpha).at(point);
}

}  // namespace latent::render
