#include "render/material/relief.h"

namespace latent::render {

Relief::Relief(const MaterialDescription& d, const FloatSource& displacement, std::uint32_t normal_map, float scale,
               const Textures& textures)
    : displacement_(displacement),
      normals_(displacement_.texture == nullptr && normal_map != kNone ? &textures.image(normal_map) : nullptr),
      scale_(scale),
      follow_v_(d.normals_follow_v) {}

void Relief::tilt(const TexturePoint& point, const SurfaceCoordinates& c, SurfaceHit& hit) const {
    if (is_flat()) return;
    // Along the plane that the shading normal stands on.
    const Vec3f n = hit.ns;
    const Vec3f tu = c.dpdu - n * dot(n, c.dpdu), tv = c.dpdv - n * dot(n, c.dpdv);
    Vec3f tilted, du;
    if (displacement_.texture) {
        // p' = p + h n has dp'/du = dp/du + dh/du n + h dn/du, differences taken over half of the footprint [PBRT4 10.5.3].
        const float h = displacement_.at(point);
        const auto shifted = [&](const Vec3f& along, Vec2f uv, float by) {
            TexturePoint there = point;
            there.p = point.p + along * by;
            there.uv = {point.uv.x + uv.x * by, point.uv.y + uv.y * by};
            there.vertices = point.vertices.moved(uv.x * by, uv.y * by);
            return (displacement_.at(there) - h) / by;
        };
        const auto step = [](float x, float y) {
            const float s = 0.5f * (std::abs(x) + std::abs(y));
            return s > 0 ? s : 5e-4f;
        };
        du = tu + n * shifted(c.dpdu, {1, 0}, step(point.duvdx.x, point.duvdy.x)) + c.dndu * h;
        const Vec3f dv = tv + n * shifted(c.dpdv, {0, 1}, step(point.duvdx.y, point.duvdy.y)) + c.dndv * h;
        tilted = cross(du, dv);
        if (dot(cross(tu, tv), n) < 0) tilted = -tilted;
    } else {
        const std::array<float, 4> rgb = normals_->at(point);
        du = c.tangent - n * dot(n, c.tangent);
        const Frame frame = Frame::from_z_x(n, du);
        const float x = scale_ * (2 * rgb[0] - 1), y = scale_ * (2 * rgb[1] - 1);
        tilted = frame.to_world({x, follow_v_ && dot(frame.y, c.bitangent) < 0 ? -y : y, 2 * rgb[2] - 1});
    }
    const float size = length(tilted);
    if (!(size > 0 && size < kInfinity)) return;
    tilted = tilted / size;
    // Turned away from the surface altogether, it is laid down to just above it.
    constexpr float kLowest = 0.01f;
    if (const float above = dot(tilted, hit.ng); above < kLowest) tilted = normalize(tilted + hit.ng * (kLowest - above));
    hit.ns = tilted;
    if (const float along = length(du); along > 0 && along < kInfinity) hit.dpdu = du;
}

}  // namespace latent::render
