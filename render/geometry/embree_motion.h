// render/geometry/embree_motion.h: an object that moves, as Embree's user geometry: a ray is taken into the space that the object
// has at its time, in double. Embree's own instances with motion would do that in float, and with another decomposition.
#pragma once

#include "render/geometry/embree.h"
#include "render/geometry/placed_shape.h"

namespace latent::render {

struct MovingGeometry {
    RTCScene object;
    const MovingInstance* instance = nullptr;
};

// `moving` and what it points to stay where they are.
RTCGeometry new_geometry(RTCDevice device, MovingGeometry& moving);

// Within Embree's own bound, 1.844e18, beyond which Debian's ends the program, as it does for what is not a number.
bool is_traceable(const Vec3f& origin, const Vec3f& direction);

}  // namespace latent::render
