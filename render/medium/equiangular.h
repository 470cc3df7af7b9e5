// render/medium/equiangular.h: distances along a segment of a ray by the angle that it fills as seen from a light's point
// [KullaFajardo12]. docs/rendering.md, "Media".
#pragma once

#include <algorithm>
#include <cmath>

#include "render/math/elementary.h"
#include "render/math/vec.h"

namespace latent::render {

// With D the distance of the light from the ray, delta [m] where the ray is nearest to it and Theta the angle of the segment, or of
// what of it lies in the cone of a spot:
//   p_E(t) = D / (Theta (D^2 + (t - delta)^2))    [1/m]
// Light falls off as the same D^2 + (t - delta)^2: what scatters there weighs the same wherever it is.
class Equiangular {
 public:
    // From `o` along unit `d`. The light shines on the directions about its unit `axis` to where 1 - cos is `outer`; cones wider
    // than a hemisphere are taken as a point.
    Equiangular(const Vec3f& o, const Vec3f& d, float length, const Vec3f& light, const Vec3f& axis, float outer)
        : length_(length) {
        const Vec3f to = light - o;
        const float r = render::length(to);
        // A ray through the light is taken to pass beside it, so that p_E stays finite: a density all the same.
        const Vec3f normal = cross(to, d);  // normal of the plane of ray and light
        D_ = std::max({render::length(normal), 1e-5f * r, 1e-15f});
        delta_ = dot(to, d);
        r2_ = D_ * D_ + delta_ * delta_;
        float last = angle_in_turns(r2_ / length - delta_, D_);
        if (outer <= 1) {
            // In the plane of ray and light the cone is a sector: `middle` +- `half`, from the start of the segment as all angles.
            const float along = dot(axis, d), across = dot(axis, d * delta_ - to) / D_;
            const float out = dot(axis, normal) / D_, square = outer * (2 - outer) - out * out;  // squared sines: narrow cones too
            if (!(square > 0)) return;
            const float half = angle_in_turns(1 - outer, std::sqrt(square));
            const float x = D_ * across - delta_ * along, y = delta_ * across + D_ * along;
            float middle = y < 0 ? -angle_in_turns(x, -y) : angle_in_turns(x, y);
            if (middle < 0.5f * last - 0.5f) middle += 1;
            first_ = std::max(0.0f, middle - half);
            last = std::min(last, middle + half);
        }
        if (!(last > first_)) return;
        turns_ = last - first_;
        begin_ = at(first_);
        end_ = at(last);
    }

    bool is_empty() const { return turns_ == 0; }  // no light on the segment
    // Not of an empty one.
    float sample(float u) const { return at(first_ + u * turns_); }
    float pdf(float t) const {
        return t >= begin_ && t <= end_ ? D_ / (2 * kPi * turns_ * (D_ * D_ + (t - delta_) * (t - delta_))) : 0;
    }

 private:
    // What is seen from the light at an angle from the start.
    float at(float turns) const {
        const SinCos a = sincos_turns(turns);
        const float t = r2_ * a.sin / (D_ * a.cos + delta_ * a.sin);
        return t >= 0 && t < length_ ? t : length_;
    }

    float length_, D_, delta_, r2_;
    float first_ = 0, turns_ = 0;  // Theta
    float begin_ = 1, end_ = 0;    // [m]
};

}  // namespace latent::render
