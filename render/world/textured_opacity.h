// render/world/textured_opacity.h: alpha of surfaces, looked up in textures.
#pragma once

#include "render/geometry/opacity.h"
#include "render/texture/footprint.h"
#include "render/texture/textures.h"

namespace latent::render {

class TexturedOpacity final : public Opacity {
 public:
    // `textures` outlive it.
    TexturedOpacity(const Textures& textures, const Footprint& footprint) : textures_(textures), footprint_(footprint) {}
    float at(const FloatInput& alpha, const SurfaceHit& hit, const SurfaceCoordinates& coordinates) const override;

 private:
    const Textures& textures_;
    Footprint footprint_;
};

}  // namespace latent::render
