// render/transport/bidirectional/weights.h: multiple importance sampling of the strategies that make the same path.
// docs/rendering.md, "Bidirectional path tracing".
#pragma once

namespace latent::render {

// A path x_0 .. x_n that s vertices of a light subpath and t of a camera subpath make together could have been made by other
// strategies too. With p_j the density of strategy j, the power heuristic weighs ours by [Veach97 9.2]
//   w = 1 / (1 + sum over the others of (p_j / p)^2) = 1 / (1 + S_camera + S_light),
// S_camera the sum over strategies with fewer camera vertices, S_light over those with fewer light vertices. Moving x_i from its
// subpath to the other one multiplies p by r_i = pdf_reverse(x_i) / pdf_forward(x_i), the densities of x_i as drawn from the other
// side and from this one. So along one subpath
//   S_i = r_i^2 (e_i + S_(i-1)),   S_(-1) = 0,
// with e_i = 1 if the strategy that ends this subpath before x_i exists: neither x_(i-1) nor x_i scatters this path by a delta
// function; for i = 0, x_0 can be hit by chance. Only r_i and r_(i-1) of the vertex that is connected depend on the other subpath;
// the rest is a partial sum that the subpath carries along [Georgiev12]. Directions of a delta function count with their
// probabilities in these ratios, and never end a subpath.
struct MisPartial {
    float end = 0;      // e_i; for a light's second vertex times the square of the ratio of its point's densities, sampled from
                        // here over sampled with its ray
    float shorter = 0;  // e_(i-1) + S_(i-2)
};

// r^2 sum; 0 if r^2 is too small for a float, however large the sum has become.
inline float mis_term(float pdf_reverse, float pdf_forward, float sum) {
    if (!(sum > 0) || !(pdf_reverse > 0)) return 0;
    const float r = pdf_reverse / pdf_forward;
    return r * r > 0 ? r * r * sum : 0;
}

// `others`: the sum of (p_j / p)^2 over the other strategies.
inline float mis_weight(float others) { return 1 / (1 + others); }

}  // namespace latent::render
