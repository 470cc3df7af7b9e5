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
    const Vec3f end = ray.o + ray.d * reach;
    std::uint32_t medium = given;
    Ray probe = ray;
    probe.o = ray.o - ray.d * reach;
    while ((probe.t_max = dot(end - probe.o, ray.d)) > 0) {
        const std::optional<SurfaceHit> hit = geometry.intersect(probe);
        if (!hit) break;
        medium = media_at(*hit).towards(ray.d, hit->ng, medium);
        probe.o = spawn_ray(hit->interaction(), ray.d).o;
    }
    return medium;
}

std::optional<SurfaceHit> March::first_hit(std::uint32_t& medium) {
    const Vec3f origin = ray_.o;
    std::optional<SurfaceHit> hit = next_hit();
    while (hit && !ray_.is_from_surface && contains(*hit, origin)) {
        medium = media_at(*hit).towards(ray_.d, hit->ng, medium);
        ray_.o = spawn_ray(hit->interaction(), ray_.d).o;
        hit = next_hit();
    }
    return hit;
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
