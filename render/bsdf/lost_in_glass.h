// render/bsdf/lost_in_glass.h: light that hits several GGX facets of an interface of clear matter. docs/rendering.md, "Surfaces".
#pragma once

#include <array>
#include <cstddef>

#include "render/math/vec.h"

namespace latent::render {

// Of what arrives on side s at cosine mu, one facet reflects the share R_s(mu) and refracts T_s(mu). The rest is lost, and leaves
// after all: on its own side, or on the other, as R : T say, all of it, in those directions from which as much is lost
// [KullaConty17]:
//   f = r_s(a) r_s(b) / (pi mean r_s) on one side, t_s(a) t_t(b) / (pi mean t_t) to the other, side t,
//   r = 1 - R - T - t, t = c_s (1 - R - T) T / (R + T)
// times the compression of radiance. c_thin or c_dense is 1, and the other is such that f is reciprocal: n_s^2 mean t_s is the same
// on both sides. Tabulated, linear in the roots of mu, of alpha and of the reflectance at normal incidence, which is at most 0.36.
class LostInGlass {
 public:
    // `eta`: the index behind the surface over that before it.
    LostInGlass(float eta, float alpha);

    struct Shares {
        float reflected = 0, refracted = 0;  // r, t
        float sum() const { return reflected + refracted; }
        float towards(bool same_side) const { return same_side ? reflected : refracted; }
    };
    Shares operator()(const Vec3f& w) const;
    // f |wi.z|, radiance not compressed.
    float f_cos(const Vec3f& wo, const Vec3f& wi) const;

 private:
    std::size_t side(const Vec3f& w) const { return (w.z > 0) == front_is_dense_ ? 1 : 0; }  // 0: the thin one
    Shares scaled(const Shares& raw, std::size_t side) const;
    bool front_is_dense_;
    int row_, index_;
    float row_fraction_, index_fraction_;
    std::array<float, 2> scale_{1, 1};  // c of each side
    std::array<Shares, 2> mean_;
};

}  // namespace latent::render
