// render/transport/bidirectional/bdpt.h: the vertices of bidirectional path tracing and the weights of its strategies.
// docs/rendering.md, "Bidirectional".
#pragma once

#include <cstdint>
#include <vector>

#include "render/transport/scattering.h"
#include "render/transport/transport.h"

namespace latent::render {

// A path x_0 .. x_n that s vertices of a light subpath and t of a camera subpath make together could have been made by other
// strategies too. With p_j the density of strategy j, the power heuristic weighs ours by
//   w = 1 / (1 + sum over the others of (p_j / p)^2) = 1 / (1 + C_camera + C_light),
// C_camera the sum over strategies with fewer camera vertices, C_light over those with fewer light vertices. Giving up one vertex
// after the other multiplies p by a_i = p(x_i from the other side) / p(x_i from this side), so along one subpath
//   C_i = a_i^2 (open_i + C_(i-1)),   C_(-1) = 0,
// with open_i = 1 if the strategy that ends this subpath before x_i exists: both x_(i-1) and x_i can be connected; for i = 0, x_0
// can be hit by chance. Only a_i and a_(i-1) of the vertex that is connected depend on the other subpath; the rest is carried
// along. Directions of a delta function count with their odds in these ratios, and never open a strategy.
inline float chained(float reverse, float forward, float rest) {
    if (!(rest > 0) || !(reverse > 0)) return 0;
    const float a = reverse / forward;
    return a * a * rest;
}

// Densities are per area (per volume in a medium), for a point of the sky per solid angle; they hold for the whole step, with the
// odds of passing media on the way.
struct SubpathVertex {
    Anchor at;
    Vec3f normal;                  // of the surface, the light or the lens; 0: none
    Vec3f wo;                      // to the previous vertex
    Scattering scattering;         // not of the first vertex
    Batch beta;                    // what arrives here: of importance, or of light
    float forward = 0;             // density from this side
    float to_previous = 0;         // times a direction's density [1/sr] here: density of the previous vertex from here
    float before = 0;              // open_(i-1) + C_(i-2)
    float open = 0;                // open_i; of a light's second vertex times the square of the ratio of its
                                   // point's densities, sampled from here over sampled with its ray
    std::uint32_t medium = kNone;  // that it was reached through
    std::uint32_t inside_medium = kNone, outside_medium = kNone;
    bool dispersed = false;
    bool in_medium = false;  // not on a surface, a light or the lens

    bool connectible() const { return !scattering.is_delta(); }
    float cosine(const Vec3f& w) const { return normal == Vec3f{} ? 1 : abs_dot(normal, w); }
    std::uint32_t medium_towards(const Vec3f& w) const {
        if (inside_medium == outside_medium) return medium;
        return dot(w, at.ng) > 0 ? outside_medium : inside_medium;
    }
};

// C_i of vertex i, connected: `reverse` its density from the other side, `previous_reverse` that of the vertex before it.
inline float connected_chain(const std::vector<SubpathVertex>& path, std::size_t i, float reverse, float previous_reverse) {
    const SubpathVertex& x = path[i];
    const float shorter = i == 0 ? 0 : chained(previous_reverse, path[i - 1].forward, x.before);
    return chained(reverse, x.forward, x.open + shorter);
}

// Multiplies what strategy (s, t) contributes: how tests make one strategy wrong on purpose and see that it shows.
struct StrategyFault {
    std::size_t s = 0, t = 0;
    float factor = 1;
};

std::unique_ptr<Integrator> make_bdpt_integrator(std::unique_ptr<World> world, const IntegratorSettings& settings,
                                                 StrategyFault fault = {});

}  // namespace latent::render
