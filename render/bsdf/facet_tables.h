// render/bsdf/facet_tables.h: means over GGX facets, tabulated: linear in the roots of the cosine mu and of alpha.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/bsdf/microfacet.h"

namespace latent::render {

template <int kSize>  // nodes
struct RootAxis {
    static float node(int i) {
        const float root = static_cast<float>(i) / (kSize - 1);
        return root * root;
    }
    static float cosine(int i) { return std::max(node(i), 1e-3f); }
    // The node below a root, and how far it is to the next one.
    static int cell(float root, float& fraction) {
        const float x = std::clamp(root, 0.0f, 1.0f) * (kSize - 1);
        const int i = std::min(static_cast<int>(x), kSize - 2);
        fraction = x - static_cast<float>(i);
        return i;
    }
    // f(i, t, weight): integral of 2 mu E(mu) is the sum of E, t of the way from node i to the next one, times the weight. Between
    // nodes E is linear in x, mu = x^2: the integral of 4 x^3 E, by Gauss's rule of 3 points, exactly.
    template <class F>
    static void for_mean(const F& f) {
        for (int i = 0; i + 1 < kSize; ++i) {
            for (const auto& [t, weight] : {std::pair(0.1127016654f, 5 / 18.0f), {0.5f, 8 / 18.0f}, {0.8872983346f, 5 / 18.0f}}) {
                const float x = (static_cast<float>(i) + t) / (kSize - 1);
                f(i, t, 4 * x * x * x * weight / (kSize - 1));
            }
        }
    }
};

// f(m) for `count` facets that wo sees, by a lattice.
template <class F>
void for_visible_facets(const Microfacets& facets, const Vec3f& wo, int count, const F& f) {
    constexpr float kGolden = 0.618033989f;
    const float share = 1 / static_cast<float>(count);
    for (int i = 0; i < count; ++i) {
        const float u = (static_cast<float>(i) + 0.5f) * share, turns = static_cast<float>(i) * kGolden,
                    v = turns - std::floor(turns);
        f(facets.sample_visible(wo, u, v));
    }
}

}  // namespace latent::render
