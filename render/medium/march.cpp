#include "render/medium/march.h"

#include <algorithm>
#include <cmath>

namespace latent::render {

namespace {

bool begins_in(const SurfaceHit& surface, const Vec3f& d, std::uint32_t medium) {
    return media_at(surface).towards(-d, surface.ng, medium) == medium;
}

// The medium behind surfaces that lie on one another, for a line along d that came through `medium`: what the line passes first is
// the one that begins there.
std::uint32_t medium_behind(std::vector<SurfaceHit> surfaces, const Vec3f& d, std::uint32_t medium) {
    while (!surfaces.empty()) {
        auto next = std::find_if(surfaces.begin(), surfaces.end(), [&](const SurfaceHit& s) { return begins_in(s, d, medium); });
        if (next == surfaces.end()) next = surfaces.begin();
        medium = media_at(*next).towards(d, next->ng, medium);
        surfaces.erase(next);
    }
    return medium;
}

}  // namespace

std::uint32_t medium_at_start(const Geometry& geometry, const Interaction& at, const Vec3f& d, float time, std::uint32_t given) {
    return medium_behind(geometry.surfaces_at(at, d, time), d, given);
}

March::March(const Geometry& geometry, const Ray& ray, float length, float metres_per_t, std::uint32_t medium, float* passed)
    : geometry_(geometry), ray_(ray), left_(length), metres_per_t_(metres_per_t), passed_(passed) {
    segment_ = {ray.o, ray.d, length, medium};
    find_hit();
    while (hit_ && ray.may_start_on_surface && contains(*hit_, {ray.o, 0, {}})) cross();
    segment_.index = 0;
}

// Whether the rest of the line leads from one side of the surface to the other.
bool March::passes(const SurfaceHit& surface) const {
    const float from = dot(surface.ng, ray_.o - surface.p);
    const float to = ray_.t_max < kInfinity ? from + dot(surface.ng, ray_.d) : dot(surface.ng, ray_.d);
    return from < 0 ? to > 0 : to < 0;
}

void March::find_hit() {
    hit_ = passed_ == nullptr ? geometry_.intersect(ray_) : geometry_.intersect_whole(ray_, *passed_);
    segment_.length = hit_ ? hit_->t * metres_per_t_ : left_;
    together_.clear();
    if (!meets_interface()) return;

    std::vector<SurfaceHit> others = geometry_.surfaces_at(hit_->interaction(), hit_->ng, ray_.time, &hit_->on);
    std::erase_if(others, [&](const SurfaceHit& s) { return !passes(s); });
    if (others.empty()) return;
    others.push_back(*hit_);
    const float t = hit_->t;
    for (const SurfaceHit& s : others) {
        const bool is_seen = !is_interface(s.material) || (s.emitter != kNone && meets_interface());
        if (is_seen) hit_ = s;
        if (is_interface(s.material)) together_.push_back(s);
    }
    hit_->t = t;
    if (is_interface(hit_->material) || hit_->inside_medium != hit_->outside_medium) return;
    // A surface that says nothing about media, on interfaces.
    std::uint32_t& before = dot(ray_.d, hit_->ng) > 0 ? hit_->inside_medium : hit_->outside_medium;
    std::uint32_t& behind = dot(ray_.d, hit_->ng) > 0 ? hit_->outside_medium : hit_->inside_medium;
    before = segment_.medium;
    behind = medium_behind(together_, ray_.d, segment_.medium);
}

void March::begin_in_medium_before_hit() {
    if (!hit_) return;
    const auto begins_here = [&](const SurfaceHit& s) { return begins_in(s, ray_.d, segment_.medium); };
    if (std::any_of(together_.begin(), together_.end(), begins_here)) return;
    segment_.medium = media_at(*hit_).towards(-ray_.d, hit_->ng, segment_.medium);
}

void March::cross() {
    if (segment_.index == 0) end_ = ray_.o + ray_.d;
    left_ = std::max(left_ - segment_.length, 0.0f);
    segment_.medium = together_.empty() ? media_at(*hit_).towards(ray_.d, hit_->ng, segment_.medium)
                                        : medium_behind(together_, ray_.d, segment_.medium);
    ++segment_.index;
    Vec3f begin = spawn_ray(hit_->interaction(), ray_.d).o;
    for (const SurfaceHit& s : together_) {
        const Vec3f behind = spawn_ray(s.interaction(), ray_.d).o;
        if (dot(behind - begin, ray_.d) > 0) begin = behind;
    }
    ray_.o = segment_.o = begin;
    if (ray_.t_max < kInfinity) {
        // Aimed anew, so that steps off the interfaces on the way do not carry the end into the far surface.
        const Vec3f to_end = end_ - ray_.o;
        if (!(dot(to_end, ray_.d) > 0)) {
            hit_ = std::nullopt;
            segment_.length = left_;
            return;
        }
        ray_.d = segment_.d = to_end;
        metres_per_t_ = length(to_end);
    }
    find_hit();
}

}  // namespace latent::render
