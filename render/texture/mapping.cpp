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
      uv_set_(d.uv_set),
      s_{static_cast<float>(d.s[0]), static_cast<float>(d.s[1])},
      t_{static_cast<float>(d.t[0]), static_cast<float>(d.t[1])},
      delta_{static_cast<float>(d.delta_u), static_cast<float>(d.delta_v)},
      v1_(d.v1),
      v2_(d.v2),
      texture_from_world_(d.texture_from_world) {}

TextureCoordinates Mapping::operator()(const TexturePoint& point) const {
    if (kind_ == MappingKind::kUv) {
        Vec2f uv = point.uv, dx = point.duvdx, dy = point.duvdy;
        const AmongVertices& at = point.vertices;
        if (uv_set_ > 0 && at.mesh != nullptr && uv_set_ <= at.mesh->more_uvs.size()) {
            const std::vector<Vec2f>& set = at.mesh->more_uvs[uv_set_ - 1];
            const Vec2f du = at.sum(set, at.du), dv = at.sum(set, at.dv);
            const auto along = [&](Vec2f d) { return Vec2f{du.x * d.x + dv.x * d.y, du.y * d.x + dv.y * d.y}; };
            uv = at.sum(set, at.weight);
            dx = along(dx);
            dy = along(dy);
        }
        const auto mapped = [&](Vec2f x) { return Vec2f{s_.x * x.x + s_.y * x.y, t_.x * x.x + t_.y * x.y}; };
        const Vec2f st = mapped(uv);
        return {{st.x + delta_[0], st.y + delta_[1]}, mapped(dx), mapped(dy)};
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
