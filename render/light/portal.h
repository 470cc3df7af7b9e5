// render/light/portal.h: a rectangle that light from infinity comes through. docs/rendering.md, "Lights".
#pragma once

#include <array>

#include "render/math/vec.h"
#include "render/sampling/uniform.h"

namespace latent::render {

// Its outside is where cross(3 - 0, 1 - 0) of its corners points: light comes from there, to points on its inside alone.
class Portal {
 public:
    explicit Portal(const std::array<Vec3d, 4>& corners);

    // Whether p, on the inside, sees direction w through it.
    bool shows(const Vec3f& p, const Vec3f& w) const;
    // Whether a straight line through p along w, in both directions, passes through it to the outside.
    bool is_crossed(const Vec3f& p, const Vec3f& w) const;
    // A direction drawn evenly from those that p sees through it [Urena13]; where these are few, through an even point of it.
    // False: p sees none.
    bool sample(const Vec3f& p, Uniform u, Uniform v, Vec3f& w) const;
    // The density [1/sr] of that, at a direction that it shows.
    float pdf_omega(const Vec3f& p, const Vec3f& w) const;

    const Vec3d& outwards() const { return z_; }
    Vec3d center() const { return corner_ + x_ * (0.5 * width_) + y_ * (0.5 * height_); }
    double radius() const { return 0.5 * std::hypot(width_, height_); }
    double area() const { return width_ * height_; }

 private:
    struct Seen;
    struct Cone;
    Vec3d corner_, x_, y_, z_;
    double width_, height_;
};

}  // namespace latent::render
