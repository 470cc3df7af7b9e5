#include "render/geometry/holes.h"

#include "render/geometry/coordinates.h"
#include "render/geometry/opacity.h"
#include "render/sampling/random.h"

namespace latent::render {

float opacity_at(const PlacedWorld& world, const SurfaceHit& hit) {
    const FloatInput& alpha = world.shape(hit.on).shape.alpha;
    if (!alpha.is_textured()) return alpha.value;
    return world.opacity == nullptr ? 1 : world.opacity->at(alpha, hit, coordinates_at(world, hit));
}

bool is_hole_at(const PrimitivePoint& on, const Vec3f& p, const Vec3f& d, float opacity) {
    if (opacity >= 1) return false;
    const std::uint64_t shape = std::uint64_t{on.instance} << 32 | on.shape;
    return !(opacity > 0) || static_cast<float>(mix(mix(shape, p), d) >> 40) * 0x1p-24f >= opacity;
}

}  // namespace latent::render
