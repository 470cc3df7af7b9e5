// render/bsdf/schlick_albedo.h: the directional albedo of GGX facets, with Schlick's reflectance or with any other, and the light
// that they reflect more than once. docs/rendering.md, "Surfaces".
#pragma once

#include <array>

namespace latent::render {

//   F(c) = f0 + (f90 - f0) (1 - c)^5  [Schlick94],  E(mu) = integral of f |cos| over directions, mu the cosine of the given one
// is linear in f0 and f90. Tabulated, linear in the root of mu and of alpha; good to about 0.001.
class SchlickAlbedo {
 public:
    // `multiscatter`: of facets with a FacetGain.
    SchlickAlbedo(float f0, float f90, float alpha, bool multiscatter = false);
    float operator()(float mu) const;
    float mean() const { return mean_; }  // integral of 2 mu E(mu)

 private:
    float f0_, f90_, mean_;
    float returned_ = 0;
    int row_;  // row of alphas, and how far it is to the next one
    float fraction_;
};

// What facets reflect once is f = F D G / (4 cos cos); the rest goes from facet to facet. All of it comes back from white facets if
// f is multiplied by g(a) g(b), with g(a) integral of f g(b) |cos b| = 1 for F = 1 [SinkhornKnopp67]. Others get 1 + R (g(a) g(b) -
// 1), R = mean F mean E / (1 - mean F (1 - mean E)) the share that returns of what white facets would give back [KullaConty17], E
// that of white facets. Reciprocal, and directions are drawn as before. Tabulated as E is.
class FacetGain {
 public:
    explicit FacetGain(float alpha);
    // g(a) g(b) - 1
    float operator()(float mu_a, float mu_b) const { return at(mu_a) * at(mu_b) - 1; }
    float returned(float mean_reflectance) const { return mean_reflectance * mean_ / (1 - mean_reflectance * (1 - mean_)); }

 private:
    float at(float mu) const;
    float mean_;
    int row_;
    float fraction_;
};

// The same of any reflectance F, cubic in the root of c between its values at kNodes cosines: the sum of F(node j) weight[j].
struct FacetWeights {
    static constexpr int kNodes = 16;
    static float node(int j);  // a cosine
    static FacetWeights at(float mu, float alpha);
    static FacetWeights mean(float alpha);

    std::array<float, kNodes> weight{};
};

}  // namespace latent::render
