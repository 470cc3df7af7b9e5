// render/bsdf/schlick_albedo.h: the directional albedo of GGX facets, with Schlick's reflectance or with any other.
// docs/rendering.md, "Surfaces".
#pragma once

#include <array>

namespace latent::render {

//   F(c) = f0 + (f90 - f0) (1 - c)^5  [Schlick94],  E(mu) = integral of f |cos| over directions, mu the cosine of the given one
// is linear in f0 and f90. Tabulated, linear in the root of mu and of alpha; good to about 0.001.
class SchlickAlbedo {
 public:
    SchlickAlbedo(float f0, float f90, float alpha);
    float operator()(float mu) const;
    float mean() const { return mean_; }  // integral of 2 mu E(mu)

 private:
    float f0_, f90_, mean_;
    int row_;  // of alphas, and how far it is to the next one
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
