// render/material/relief.h: surfaces that look uneven: shading normals from a displacement (bump map) or a normal map.
// docs/rendering.md, "Relief".
#pragma once

#include "render/geometry/geometry.h"
#include "render/scene/description.h"
#include "render/texture/textures.h"

namespace latent::render {

class Relief {
 public:
    // `textures` outlive it.
    Relief(const MaterialDescription& description, const Textures& textures);

    bool is_flat() const { return displacement_.texture == nullptr && normals_ == nullptr; }
    // Tilts hit.ns, and hit.dpdu with it. The point stays where it is, and so does ng.
    void tilt(const TexturePoint& point, const SurfaceCoordinates& coordinates, SurfaceHit& hit) const;

 private:
    FloatSource displacement_;
    const ImageLookup* normals_;
    float scale_;
    bool follow_v_;
};

}  // namespace latent::render
