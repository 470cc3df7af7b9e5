// render/texture/mapping.h: from a point of a surface to the coordinates of a texture, footprints with it. docs/scenes.md,
// "Textures".
#pragma once

#include "render/scene/texture.h"
#include "render/texture/texture.h"

namespace latent::render {

struct TextureCoordinates {
    Vec2f st;
    Vec2f dstdx, dstdy;
};

// To the plane.
class Mapping {
 public:
    explicit Mapping(const MappingDescription& description);
    TextureCoordinates operator()(const TexturePoint& point) const;

 private:
    MappingKind kind_;
    std::uint32_t uv_set_;
    Vec2f s_, t_;
    float delta_[2];
    Vec3f v1_, v2_;
    Affinef texture_from_world_;
};

// To texture space.
struct SpacePoint {
    Vec3f p, dpdx, dpdy;
};
class SpaceMapping {
 public:
    explicit SpaceMapping(const MappingDescription& description) : texture_from_world_(description.texture_from_world) {}
    SpacePoint operator()(const TexturePoint& point) const {
        return {texture_from_world_.point(point.p), texture_from_world_.vector(point.dpdx), texture_from_world_.vector(point.dpdy)};
    }

 private:
    Affinef texture_from_world_;
};

}  // namespace latent::render
