#include "render/medium/march.h"

#include <algorithm>
#include <cmath>

namespace latent::render {

namespace {

// Whether the surface, as a plane at the hit, contains p to within what is known of it.
bool contains(const SurfaceHit& hit, const Vec3f& p) {
    const Vec3f to = p - hit.p;
    const float known = hit.error * (std::abs(hit.ng.x) + std::abs(hit.ng.y) + std::abs(hit.ng.z)) + kRayError * length(to);
    return std::abs(dot(hit.ng, to)) <= known;
}

}  // namespace

std::uint32_t medium_at_start(const Geometry& geometry, const Ray& ray, std::uint32_t given) {
    // From a little before the origin to a little behind: from the origin itself a ray meets the surface or not, as it rounds.
    const float reach = 0x1p-18f * geometry.radius();
    if (!(reach > 0)) return given;
    const Ray around{ray.o - ray.d * reach, ray.d * (2 * reach), 1, ray.time};
    float passed = 1;
    std::uint32_t medium = given;
    for (March march(geometry, around, 2 * reach, given, passed); march.hit(); march.cross()) {
        const SurfaceHit& hit = *march.hit();
        if (contains(hit, ray.o)) medium = media_at(hit).towards(ray.d, hit.ng, medium);
    }
    return medium;
}

March::March(const Geometry& geometry, const Ray& ray, float length, float metres_per_t, std::uint32_t medium, float* passed)
    : geometry_(geometry), ray_(ray), left_(length), metres_per_t_(metres_per_t), passed_(passed), hit_(next_hit()) {
    segment_ = {ray.o, ray.d, hit_ ? hit_->t * metres_per_t : length, medium};
    while (hit_ && ray.may_start_on_surface && contains(*hit_, ray.o)) cross();
    segment_.index = 0;
}

void March::cross() {
    if (segment_.index == 0) end_ = ray_.o + ray_.d;
    left_ = std::max(left_ - segment_.length, 0.0f);
    segment_.medium = media_at(*hit_).towards(ray_.d, hit_->ng, segment_.medium);
    ++segment_.index;
    ray_.o = segment_.o = spawn_ray(hit_->interaction(), ray_.d).o;
    bool goes_on = true;
    if (ray_.t_max < kInfinity) {
        // Aimed anew, so that steps off the interfaces on the way do not carry the end into the far surface.
        const Vec3f to_end = end_ - ray_.o;
        goes_on = dot(to_end, ray_.d) > 0;
        if (goes_on) {
            ray_.d = segment_.d = to_end;
            metres_per_t_ = length(to_end);
        }
    }
    hit_ = goes_on ? next_hit() : std::nullopt;
    segment_.length = hit_ ? hit_->t * metres_per_t_ : left_;
}

}  // namespace latent::render
