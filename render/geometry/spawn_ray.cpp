#include "render/geometry/geometry.h"

namespace latent::render {

namespace {

constexpr float kShadowEnd = 0.9999f;  // of a ray between two points: the far surface is not in the way of itself

// Pushes p off its surface, to the side of w, by a bound on how far it may be from the true surface [PBRT4 6.8.6].
Vec3f offset(const Anchor& from, const Vec3f& w) {
    const float distance = from.error * (std::abs(from.ng.x) + std::abs(from.ng.y) + std::abs(from.ng.z));
    const Vec3f shift = from.ng * (dot(w, from.ng) < 0 ? -distance : distance);
    const auto push = [](float p, float by) {
        const float moved = p + by;
        if (by > 0) return std::nextafter(moved, kInfinity);
        return by < 0 ? std::nextafter(moved, -kInfinity) : moved;
    };
    return {push(from.p.x, shift.x), push(from.p.y, shift.y), push(from.p.z, shift.z)};
}

}  // namespace

Ray spawn_ray(const Anchor& from, const Vec3f& d) { return {offset(from, d), d}; }

Ray spawn_ray(const Anchor& from, const Anchor& to) {
    const Vec3f d = to.p - from.p, begin = offset(from, d), end = offset(to, -d);
    return {begin, end - begin, kShadowEnd};
}

}  // namespace latent::render
