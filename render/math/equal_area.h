// render/math/equal_area.h: the equal-area map between the sphere and the unit square [Clarberg08], as pbrt-v4 orients it.
#pragma once

#include "render/math/vec.h"

namespace latent::render {

// Unit vector -> point of [0,1]^2 and back; areas scale by 1 / (4 pi) everywhere. The square's centre is +z, its corners are -z.
Vec2f square_from_sphere(const Vec3f& d);
Vec3f sphere_from_square(const Vec2f& p);

}  // namespace latent::render
