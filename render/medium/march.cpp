#include "render/medium/march.h"

#include <algorithm>
#include <cmath>

namespace latent::render {

namespace {

// The medium behind surfaces that lie on one another, for a line along d. Each begins in the medium behind the one before, whatever
// their order here, so it is the one that lies behind more of them than before. None: they say nothing of media, or lead back to
// the medium that the line came from.
std::optional<std::uint32_t> medium_behind(const std::vector<SurfaceHit>& surfaces, const Vec3f& d) {
    std::optional<std::uint32_t> medium;
    std::ptrdiff_t most = 0;
    for (const SurfaceHit& s : surfaces) {
        const std::uint32_t behind = media_at(s).towards(d, s.ng, kNone);
        std::ptrdiff_t more = 0;
        for (const SurfaceHit& other : surfaces) {
            if (other.inside_medium == other.outside_medium) continue;
            more += media_at(other).towards(d, other.ng, kNone) == behind;
            more -= media_at(other).towards(-d, other.ng, kNone) == behind;
        }
        if (more > most) most = more, medium = behind;
    }
    return medium;
}

// So that what leaves a point, or a hit, also leaves a surface that contains it.
float widened(const Interaction& at, const SurfaceHit& surface) {
    return std::max(at.error, surface.error + std::abs(dot(surface.ng, at.p - surface.p)));
}

}  // namespace

std::uint32_t medium_at_start(const Geometry& geometry, Interaction& at, const Vec3f& d, float time, std::uint32_t given) {
    std::vector<SurfaceHit> surfaces = geometry.surfaces_at(at, d, time);
    // Of a lamp's own surface `given` is the side.
    if (at.ng != Vec3f{}) std::erase_if(surfaces, [](const SurfaceHit& s) { return !is_interface(s.material); });
    for (const SurfaceHit& s : surfaces) at.error = widened(at, s);
    if (const std::optional<std::uint32_t> medium = medium_behind(surfaces, d)) return *medium;
    // Of two boxes of one medium that touch, as of others, the line leads into the one that it enters.
    const auto is_entered = [&](const SurfaceHit& s) { return s.inside_medium != s.outside_medium && dot(d, s.ng) < 0; };
    const auto entered = std::find_if(surfaces.begin(), surfaces.end(), is_entered);
    return entered == surfaces.end() ? given : entered->inside_medium;
}

March::March(const Geometry& geometry, const Ray& ray, float length, float metres_per_t, std::uint32_t medium, float* passed)
    : geometry_(geometry), ray_(ray), left_(length), metres_per_t_(metres_per_t), passed_(passed) {
    segment_ = {ray.o, ray.d, length, medium};
    find_hit();
    if (!hit_ || !ray.may_start_on_surface || !contains(*hit_, {ray.o, 0, {}})) return;
    while (hit_ && contains(*hit_, {ray.o, 0, {}})) cross();
    Interaction start{ray.o, 0, {}};
    segment_.medium = medium_at_start(geometry, start, normalize(ray.d), ray.time, medium);
    segment_.index = 0;
    if (hit_ && !together_.empty()) set_media_of_hit();
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
    const bool is_blocked = passed_ != nullptr && hit_ && !meets_interface();
    if (!hit_ || is_blocked || !geometry_.has_interfaces()) return;

    const bool leads_out = dot(ray_.d, hit_->ng) > 0;
    together_ = geometry_.surfaces_at(hit_->interaction(), leads_out ? hit_->ng : -hit_->ng, ray_.time, &hit_->on);
    std::erase_if(together_, [&](const SurfaceHit& s) {
        // Next to an edge, the shape itself is there again.
        const bool is_same =
            s.on.instance == hit_->on.instance && s.on.shape == hit_->on.shape && (dot(ray_.d, s.ng) > 0) == leads_out;
        return is_same || !passes(s);
    });
    if (together_.empty()) return;
    for (SurfaceHit& s : together_) geometry_.open_hole(s, ray_.d, passed_);
    together_.push_back(*hit_);
    const auto solid =
        std::find_if(together_.begin(), together_.end(), [](const SurfaceHit& s) { return !is_interface(s.material); });
    if (meets_interface() && solid != together_.end()) {
        const float t = hit_->t;
        hit_ = *solid;
        hit_->t = t;
    }
    for (const SurfaceHit& s : together_) {
        if (is_interface(s.material)) hit_->error = widened(hit_->interaction(), s);
    }
    set_media_of_hit();
}

void March::set_media_of_hit() {
    const bool leads_out = dot(ray_.d, hit_->ng) > 0;
    (leads_out ? hit_->inside_medium : hit_->outside_medium) = segment_.medium;
    (leads_out ? hit_->outside_medium : hit_->inside_medium) = medium_behind(together_, ray_.d).value_or(segment_.medium);
}

std::optional<std::uint32_t> March::medium_before_hit() const {
    if (!hit_) return std::nullopt;
    return together_.empty() ? medium_behind({*hit_}, -ray_.d) : medium_behind(together_, -ray_.d);
}

void March::begin_in_medium_before_hit() {
    segment_.medium = medium_before_hit().value_or(segment_.medium);
    if (!together_.empty()) set_media_of_hit();
}

void March::cross() {
    if (segment_.index == 0) end_ = ray_.o + ray_.d;
    left_ = std::max(left_ - segment_.length, 0.0f);
    segment_.medium = media_at(*hit_).towards(ray_.d, hit_->ng, segment_.medium);
    ++segment_.index;
    ray_.o = segment_.o = spawn_ray(hit_->interaction(), ray_.d).o;
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
