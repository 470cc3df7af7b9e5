// render/math/equal_area.h: the equal-area map between the sphere and the unit square [Clarberg08], as pbrt-v4 orients it.
#pragma once

#include "render/math/vec.h"

namespace latent::render {

// Unit vector -> point of [-1,1]^2 and back; areas scale by 1 / pi everywhere. The square's centre is +z, its corners are -z. Near
// +z both are as exact as floats near 0.
Vec2f centred_from_sphere(const Vec3f& d);
Vec3f sphere_from_centred(const Vec2f& p);

// The same, of [0,1]^2.
inline Vec2f square_from_sphere(const Vec3f& d) {
    const Vec2f p = centred_from_sphere(d);
    return {(p.x + 1) * 0.5f, (p.y + 1) * 0.5f};
}
inline Vec3f sphere_from_square(const Vec2f& p) { return sphere_from_centred({2 * p.x - 1, 2 * p.y - 1}); }

}  // namespace latent::render
