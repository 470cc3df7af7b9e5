// render/light/light_bounds.h: where lights are and which way they shine: of one light, and of many together. docs/rendering.md,
// "Choice of lights".
#pragma once

#include "render/scene/bounds.h"

namespace latent::render {

// Nothing of it is left out: all light starts in the box, and in the ball, in directions within `spread` + `falloff` of the axis.
// Angles are in turns.
struct LightBounds {
    Box box{};
    Vec3d center{};
    double radius = 0;         // the ball's
    Vec3d axis{0, 0, 1};       // unit
    float spread = 0.5f;       // from the axis to any direction in which some part shines most
    float falloff = 0.25f;     // from there to where it shines no more
    bool both_sides = false;   // the axis and its opposite are alike
    double concentration = 0;  // [1/sr] of one light: intensity where it is greatest, over power
    double intensity = 0;      // where it is greatest, weighed by wavelength; the sum for several lights

    // Light from a ball, or a box, in all directions.
    static LightBounds from_ball(const Vec3d& center, double radius);
    static LightBounds from_box(const Box& box);
    // Directions about a unit vector. All of them, as before, if it is none: the normal of a shape that is too large to have one.
    void point(const Vec3d& axis_, float spread_, float falloff_) {
        const double length2 = length_squared(axis_);
        if (!(length2 > 0.5 && length2 < 2)) return;
        axis = axis_;
        spread = spread_;
        falloff = falloff_;
    }

    // How much room it takes up, in space and in direction: what the sum over both halves of a split is to be small of
    // [EstevezKulla18].
    double measure() const;
};

// Bounds of both together; their `concentration` has no meaning.
LightBounds operator+(const LightBounds& a, const LightBounds& b);

}  // namespace latent::render
