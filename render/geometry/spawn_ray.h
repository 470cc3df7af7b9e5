// render/geometry/spawn_ray.h: rays, and how one starts clear of the surface that it leaves. docs/scenes.md, "Geometry".
#pragma once

#include "render/math/vec.h"

namespace latent::render {

struct Ray {
    Vec3f o, d;  // d need not have unit length; t counts in lengths of d
    float t_max = kInfinity;
    float time = 0;                     // for all motions: from 0, their start, to 1
    bool may_start_on_surface = false;  // o has no known normal: the first solid is none that contains it
    bool seen = false;                  // what it meets is seen by the camera, which sees backdrops, too

    Ray at_time(float then, bool is_seen = false) const { return {o, d, t_max, then, may_start_on_surface, is_seen}; }
};

// What a ray's float arithmetic adds to the error of a surface that it comes to, per length of the ray: eight half ulps.
inline constexpr float kRayError = 0x1p-21f;

// A point that rays may leave from or lead to: the true point is within `error` of `p` in each coordinate, seen by a ray of length
// l within error + error_per_length l; `ng` is unit length, or 0 for a point that lies on no surface (in a medium, on a lens).
struct Interaction {
    Vec3f p;
    float error = 0;
    Vec3f ng;
    float error_per_length = kRayError;
};

// A ray from `from` in direction `d`: starts clear of the surface, on the side that d points to [PBRT4 6.8.6].
Ray spawn_ray(const Interaction& from, const Vec3f& d);
// The same to a point, clear of both surfaces: whatever else lies between them, nearer than that to the one or the other, is met.
Ray spawn_ray(const Interaction& from, const Interaction& to);

}  // namespace latent::render
