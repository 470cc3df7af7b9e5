// render/scene/bounds.h: boxes about shapes, in double.
#pragma once

#include <algorithm>
#include <limits>

#include "render/scene/description.h"

namespace latent::render {

struct Box {
    Vec3d low{kEmpty, kEmpty, kEmpty}, high{-kEmpty, -kEmpty, -kEmpty};

    bool is_empty() const { return !(low.x <= high.x); }
    Vec3d middle() const { return low * 0.5 + high * 0.5; }
    void add(const Vec3d& p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    void add(const Box& b) {
        add(b.low);
        add(b.high);
    }
    // The distance of its farthest point from p.
    double reach(const Vec3d& p) const {
        return length(
            Vec3d(std::max(p.x - low.x, high.x - p.x), std::max(p.y - low.y, high.y - p.y), std::max(p.z - low.z, high.z - p.z)));
    }
    // Its point that is nearest to p.
    Vec3d nearest(const Vec3d& p) const {
        return {std::clamp(p.x, low.x, high.x), std::clamp(p.y, low.y, high.y), std::clamp(p.z, low.z, high.z)};
    }

 private:
    static constexpr double kEmpty = std::numeric_limits<double>::infinity();
};

// About the image of the unit cube.
inline Box unit_cube_box(const Affined& m) {
    Box box;
    for (int corner = 0; corner < 8; ++corner)
        box.add(m.point({static_cast<double>(corner & 1), static_cast<double>(corner >> 1 & 1), static_cast<double>(corner >> 2)}));
    return box;
}

// About a whole quadric, in the space that it is mapped to: the image of the ball (disk) of radius r reaches r |row of the linear
// part| along each axis, that of a cylinder its axis further.
inline Box quadric_box(const ShapeDescription& shape) {
    const Affined& m = shape.to_world;
    const bool ball = shape.kind == ShapeKind::kSphere, tube = shape.kind == ShapeKind::kCylinder;
    const double middle = ball   ? 0
                          : tube ? 0.5 * (shape.z_min + shape.z_max)
                                 : shape.height,
                 along = tube ? 0.5 * (shape.z_max - shape.z_min) : 0;
    const Vec3d center = m.point({0, 0, middle});
    const auto reach = [&](double x, double y, double z) {
        return shape.radius * std::hypot(x, y, ball ? z : 0.0) + along * std::abs(z);
    };
    const Vec3d half(reach(m.x.x, m.y.x, m.z.x), reach(m.x.y, m.y.y, m.z.y), reach(m.x.z, m.y.z, m.z.z));
    Box box;
    box.add(center - half);
    box.add(center + half);
    return box;
}

}  // namespace latent::render
