#include "render/texture/mapping.h"

namespace latent::render {

namespace {

// Coordinates (dot(ds, d), dot(dt, d)) of the footprint's axes; a pole of the mapping has none.
TextureCoordinates coordinates(Vec2f st, const Vec3f& ds, const Vec3f& dt, const Vec3f& dpdx, const Vec3f& dpdy) {
    const auto finite = [](float x) { return std::abs(x) < kInfinity ? x : 0; };
    return {st, {finite(dot(ds, dpdx)), finite(dot(dt, dpdx))}, {finite(dot(ds, dpdy)), finite(dot(dt, dpdy))}};
}

}  // namespace

Mapping::Mapping(const MappingDescription& d)
    : kind_(d.kind),
      scale_{static_cast<float>(d.scale_u), static_cast<float>(d.scale_v)},
      delta_{static_cast<float>(d.delta_u), static_cast<float>(d.delta_v)},
      v1_(d.v1),
      v2_(d.v2),
      texture_from_world_(d.texture_from_world) {}

TextureCoordinates Mapping::operator()(const TexturePoint& point) const {
    if (kind_ == MappingKind::kUv) {
        return {{scale_[0] * point.uv.x + delta_[0], scale_[1] * point.uv.y + delta_[1]},
                {scale_[0] * point.duvdx.x, scale_[1] * point.duvdx.y},
                {scale_[0] * point.duvdy.x, scale_[1] * point.duvdy.y}};
    }
    const Vec3f p = texture_from_world_.point(point.p), dpdx = texture_from_world_.vector(point.dpdx),
                dpdy = texture_from_world_.vector(point.dpdy);
    if (kind_ == MappingKind::kPlanar) return coordinates({delta_[0] + dot(p, v1_), delta_[1] + dot(p, v2_)}, v1_, v2_, dpdx, dpdy);
    const float ring2 = p.x * p.x + p.y * p.y, ring = std::sqrt(ring2);
    const Vec3f dphi = Vec3f(-p.y, p.x, 0) / (2 * kPi * ring2);
    const float phi = std::atan2(p.y, p.x) / (2 * kPi);
    if (kind_ == MappingKind::kCylindrical) return coordinates({0.5f + phi, p.z}, dphi, {0, 0, 1}, dpdx, dpdy);
    // s is the angle from the z axis over pi, t the angle about it over 2 pi.
    const Vec3f dtheta = Vec3f(p.x * p.z / ring, p.y * p.z / ring, -ring) / (kPi * (ring2 + p.z * p.z));
    return coordinates({std::atan2(ring, p.z) / kPi, phi < 0 ? phi + 1 : phi}, dtheta, dphi, dpdx, dpdy);
}

}  // namespace latent::render
