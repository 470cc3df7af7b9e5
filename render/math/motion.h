// render/math/motion.h: affine maps that change with time. docs/scenes.md, "Motion".
#pragma once

#include "render/math/vec.h"

namespace latent::render {

// Between two maps, from time 0 to 1. Each is taken apart into p -> t + R S (p - c): a rotation R and a symmetric S about a centre
// c, as pbrt-v4 does [Shoemake92]. t, the image of the centre, and S change at constant rates; R turns at a constant rate, less
// than half round. So a motion between two rigid maps is rigid.
class Motion {
 public:
    // Neither map is singular, and both or neither swap handedness.
    Motion(const Affined& start, const Affined& end, const Vec3d& center = {});

    // Before 0 and after 1 nothing moves.
    Affined at(double time) const;
    bool turns() const { return angle_ > 0; }
    // Bound on the length of the second derivative, by time, of the image of p: how far it strays from a straight line.
    double bend(const Vec3d& p) const;

 private:
    struct Quaternion {
        double w = 1;
        Vec3d v{};
    };
    struct Parts {
        Quaternion rotation;
        Affined stretch;  // linear
    };
    static Parts parts_of(const Affined& map);
    static Quaternion quaternion_of(const Affined& rotation);
    static Affined rotation_of(const Quaternion& q);

    Affined start_, end_;
    Vec3d center_, from_, to_;  // to_: of the centre, as from_
    Parts first_, last_;
    double angle_;  // between the quaternions: half of that of the turn
};

}  // namespace latent::render
