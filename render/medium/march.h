// render/medium/march.h: the segments of a line of sight, each in one medium.
#pragma once

#include <cstdint>

#include "render/geometry/geometry.h"

namespace latent::render {

// Farther than any scene; products with it stay finite.
inline constexpr float kFar = 1e30f;

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

// The medium that a line along unit d begins in, at `time`, from a light source or a lens at p: `given`, but on an interface the
// one on the side that d leads to, and p is moved there.
std::uint32_t medium_at_start(const Geometry& geometry, Vec3f& p, const Vec3f& d, float time, std::uint32_t given);

// The part of a line that lies in one medium.
struct Segment {
    Vec3f o, d;        // from o in direction d, which need not have unit length
    float length = 0;  // [m]; kFar: without end
    std::uint32_t medium = kNone;
    std::uint32_t index = 0;  // along the line
};

// Goes along a traced line, from its start to its hit, from segment to segment.
class March {
 public:
    // The ray begins in `medium`. Where it hits nothing, it ends after `length` metres. `line` must outlive this.
    March(const Line& line, const Ray& ray, float length, std::uint32_t medium);

    const Segment& segment() const { return segment_; }
    // False: this was the last segment.
    bool next();

 private:
    float end_of_segment() const;  // [m] from the start of the line

    const Line& line_;
    Vec3f o_;
    float metres_per_t_, length_;
    Segment segment_;
};

}  // namespace latent::render
