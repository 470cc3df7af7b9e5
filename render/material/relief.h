// render/material/relief.h: surfaces that look uneven: shading normals from a displacement (bump map) or a normal map.
// docs/rendering.md, "Relief".
#pragma once

#include "render/geometry/geometry.h"
#include "render/scene/description.h"
#include "render/texture/textures.h"

namespace latent::render {

class Relief {
 public:
    // The relief of a surface, and that of its coat, which is smooth unless it has a normal map of its own. `textures` outlive it.
    static Relief of_surface(const MaterialDescription& d, const Textures& textures) {
        return Relief(d, textures.source(d.displacement), d.normal_map, d.normal_scale, textures);
    }
    static Relief of_coat(const MaterialDescription& d, const Textures& textures) {
        return Relief(d, {}, d.coat_normal_map, d.coat_normal_scale, textures);
    }

    bool is_flat() const { return displacement_.texture == nullptr && normals_ == nullptr; }
    // Tilts hit.ns, and hit.dpdu with it. The point stays where it is, and so does ng.
    void tilt(const TexturePoint& point, const SurfaceCoordinates& coordinates, SurfaceHit& hit) const;

 private:
    Relief(const MaterialDescription& d, const FloatSource& displacement, std::uint32_t normal_map, float scale,
           const Textures& textures);

    FloatSource displacement_;
    const ImageLookup* normals_;
    float scale_;
    bool follow_v_;
};

}  // namespace latent::render
