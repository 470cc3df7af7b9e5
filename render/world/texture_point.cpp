#include "render/world/texture_point.h"

namespace latent::render {

void fill_in(const SurfaceHit& hit, const SurfaceCoordinates& c, const Footprint& footprint, TexturePoint& point) {
    point.p = hit.p;
    point.n = hit.ns;
    point.uv = c.uv;
    point.vertices = c.vertices;
    footprint.at(hit.p, hit.ng, point.dpdx, point.dpdy);
    // d = dpdu x + dpdv y, as nearly as a vector off the plane of both can be.
    const float a = dot(c.dpdu, c.dpdu), b = dot(c.dpdu, c.dpdv), d = dot(c.dpdv, c.dpdv), determinant = a * d - b * b;
    const auto solve = [&](const Vec3f& v) {
        const float x = dot(c.dpdu, v), y = dot(c.dpdv, v);
        const Vec2f out{(d * x - b * y) / determinant, (a * y - b * x) / determinant};
        return std::abs(out.x) < 1e8f && std::abs(out.y) < 1e8f ? out : Vec2f{};
    };
    point.duvdx = solve(point.dpdx);
    point.duvdy = solve(point.dpdy);
}

}  // namespace latent::render
