// render/medium/march.h: the one walk along a straight line through interfaces and media: segment by segment, each in one medium.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/geometry/geometry.h"

namespace latent::render {

// Farther than any scene; products with it stay finite.
inline constexpr float kFar = 1e30f;

// The material of surfaces that scatter nothing: where media meet.
inline bool is_interface(std::uint32_t material) { return material == kNone; }

// The media on the sides of a surface.
struct MediumInterface {
    std::uint32_t inside = kNone, outside = kNone;

    // The one on the side that w points to, for a ray that came through `current`.
    std::uint32_t towards(const Vec3f& w, const Vec3f& ng, std::uint32_t current) const {
        if (inside == outside) return current;
        return dot(w, ng) > 0 ? outside : inside;
    }
};
inline MediumInterface media_at(const SurfaceHit& hit) { return {hit.inside_medium, hit.outside_medium}; }

// The medium that a line along unit d begins in, at `time`, from a light source or a lens: `given`, but on an interface the one on
// the side that d leads to. Widens the error of a point on a surface so that rays start clear of others that lie there too.
std::uint32_t medium_at_start(const Geometry& geometry, Interaction& at, const Vec3f& d, float time, std::uint32_t given);

// The part of a line that lies in one medium.
struct Segment {
    Vec3f o, d;        // from o in direction d, which need not have unit length
    float length = 0;  // [m]; kFar: without end
    std::uint32_t medium = kNone;
    std::uint32_t index = 0;  // along the line
};

// Begins on the first segment of the line. Surfaces that lie on one another, in a scene with interfaces, are met as one: it is made
// of what is no interface among them, and parts the media that all of them together part.
class March {
 public:
    // Along unit ray.d, without end.
    March(const Geometry& geometry, const Ray& ray, std::uint32_t medium) : March(geometry, ray, kFar, 1, medium, nullptr) {}
    // `length` metres, which is as far as the ray goes. Passes surfaces that are there in part.
    March(const Geometry& geometry, const Ray& ray, float length, std::uint32_t medium, float& passed)
        : March(geometry, ray, length, render::length(ray.d), medium, &passed) {}

    const Segment& segment() const { return segment_; }
    // The surface that the segment ends on, with the media on the line's way if there are others in its place; none: the line ends.
    const std::optional<SurfaceHit>& hit() const { return hit_; }
    bool meets_interface() const { return hit_ && is_interface(hit_->material); }
    // Goes on behind that surface, whatever it is made of.
    void cross();
    // For a line whose medium is a guess: the surface that it meets first knows better.
    void begin_in_medium_before_hit();
    // The medium in which the line comes to that surface, if the surface has a say in it.
    std::optional<std::uint32_t> medium_before_hit() const;

 private:
    // A lamp, a lens or a vertex in a medium may have been put on a surface, which then is not in the way: the line begins on the
    // side that it leads to, in the medium there.
    March(const Geometry& geometry, const Ray& ray, float length, float metres_per_t, std::uint32_t medium, float* passed);

    void find_hit();
    bool passes(const SurfaceHit& surface) const;
    void set_media_of_hit();

    const Geometry& geometry_;
    Ray ray_;
    Vec3f end_;   // of a ray that ends, once it has crossed a surface
    float left_;  // [m] of the line, from the start of the segment on
    float metres_per_t_;
    float* passed_;  // multiplied by the shares that surfaces let pass; null: a hash decides which of them are met
    std::optional<SurfaceHit> hit_;
    std::vector<SurfaceHit> together_;  // all surfaces at the hit, if there are several
    Segment segment_;
};

}  // namespace latent::render
