#include "render/geometry/spawn_ray.h"

#include "render/math/next_float.h"

namespace latent::render {

namespace {

// Pushes p off its surface, to the side of w, by a bound on how far it may be from the true surface [PBRT4 6.8.6].
Vec3f offset(const Interaction& from, float error, const Vec3f& w) {
    const float distance = error * (std::abs(from.ng.x) + std::abs(from.ng.y) + std::abs(from.ng.z));
    const Vec3f shift = from.ng * (dot(w, from.ng) < 0 ? -distance : distance);
    const auto push = [](float p, float by) {
        const float moved = p + by;
        if (by > 0) return next_up(moved);
        return by < 0 ? next_down(moved) : moved;
    };
    return {push(from.p.x, shift.x), push(from.p.y, shift.y), push(from.p.z, shift.z)};
}

}  // namespace

Ray spawn_ray(const Interaction& from, const Vec3f& d) {
    return {offset(from, from.error, d), d, kInfinity, 0, from.ng == Vec3f{}};
}

Ray spawn_ray(const Interaction& from, const Interaction& to) {
    const Vec3f d = to.p - from.p, begin = offset(from, from.error, d);
    // Clear of the far surface by what is not known about where the ray hits that, along the normal: so at any angle.
    const Vec3f end = offset(to, to.error + to.error_per_length * max_abs(d), -d);
    // A point without a normal may have been put on a surface all the same.
    return {begin, end - begin, to.ng == Vec3f{} ? 1 - kRayError : 1, 0, from.ng == Vec3f{}};
}

}  // namespace latent::render
