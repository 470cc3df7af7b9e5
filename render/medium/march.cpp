#include "render/medium/march.h"

#include <algorithm>

namespace latent::render {

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
