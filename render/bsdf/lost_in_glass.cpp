#include "render/bsdf/lost_in_glass.h"

#include <algorithm>
#include <cmath>

#include "render/bsdf/facet_tables.h"
#include "render/bsdf/fresnel.h"
#include "render/sampling/warp.h"

namespace latent::render {

namespace {

constexpr int kNodes = 16;         // along each axis
constexpr int kGlassFacets = 512;  // at each node
constexpr float kMaxRoot = 0.6f;   // largest root of the reflectance
using GlassAxis = RootAxis<kNodes>;
using Shares = LostInGlass::Shares;

Shares between(const Shares& a, const Shares& b, float t) {
    return {a.reflected + (b.reflected - a.reflected) * t, a.refracted + (b.refracted - a.refracted) * t};
}

// The losses at each side, for one alpha and one index, with c = 1.
struct Losses {
    std::array<std::array<Shares, kNodes>, 2> at{};  // [side][mu]
    std::array<Shares, 2> mean{};
};

// By single facets.
Shares lost(float mu, float alpha, float eta) {
    const Microfacets facets = Microfacets::of_alpha(alpha, alpha);
    const Vec3f wo{std::sqrt(1 - mu * mu), 0, mu};
    float reflected = 0, refracted = 0;
    for_visible_facets(facets, wo, kGlassFacets, [&](const Vec3f& m) {
        const float c = dot(wo, m), f = fresnel_dielectric(c, eta);
        const auto share = [&](const Vec3f& wi) { return facets.masking_shadowing(wo, wi) / (facets.masking(wo) * kGlassFacets); };
        const Vec3f mirrored = m * (2 * c) - wo;
        Vec3f through;
        if (mirrored.z > 0) reflected += f * share(mirrored);
        if (refract(wo, m, eta, through) && through.z < 0) refracted += (1 - f) * share(through);
    });
    const float sum = reflected + refracted, share = std::max(1 - sum, 0.0f) / sum;
    return {reflected * share, refracted * share};
}

Losses losses(float alpha, float eta) {
    Losses out;
    for (const std::size_t side : {0, 1}) {
        for (int i = 0; i < kNodes; ++i) out.at[side][i] = lost(GlassAxis::cosine(i), alpha, side == 0 ? eta : 1 / eta);
        GlassAxis::for_mean([&](int i, float t, float weight) {
            const Shares here = between(out.at[side][i], out.at[side][i + 1], t);
            out.mean[side].reflected += here.reflected * weight, out.mean[side].refracted += here.refracted * weight;
        });
    }
    return out;
}

struct GlassTable {
    std::array<std::array<Losses, kNodes>, kNodes> at;  // [alpha][index]
    GlassTable() {
        for (int a = 0; a < kNodes; ++a) {
            for (int i = 0; i < kNodes; ++i) {
                const float root = kMaxRoot * static_cast<float>(i) / (kNodes - 1);
                at[a][i] = losses(GlassAxis::node(a), (1 + root) / (1 - root));
            }
        }
    }
};

const GlassTable& glass_table() {
    static const GlassTable t;
    return t;
}

// f of a Losses, between the rows of two alphas and of two indices.
template <class F>
Shares interpolated(int row, float row_fraction, int index, float index_fraction, const F& f) {
    const auto along_index = [&](int a) {
        return between(f(glass_table().at[a][index]), f(glass_table().at[a][index + 1]), index_fraction);
    };
    return between(along_index(row), along_index(row + 1), row_fraction);
}

}  // namespace

LostInGlass::LostInGlass(float eta, float alpha)
    : front_is_dense_(eta < 1),
      row_(GlassAxis::cell(std::sqrt(alpha), row_fraction_)),
      index_(GlassAxis::cell(std::abs(eta - 1) / ((eta + 1) * kMaxRoot), index_fraction_)) {
    for (const std::size_t side : {0, 1})
        mean_[side] = interpolated(row_, row_fraction_, index_, index_fraction_, [&](const Losses& l) { return l.mean[side]; });
    const float n = std::max(eta, 1 / eta), thin = mean_[0].refracted, dense = n * n * mean_[1].refracted,
                least = std::min(thin, dense);
    if (least > 0) scale_ = {least / thin, least / dense};
    for (const std::size_t side : {0, 1}) mean_[side] = scaled(mean_[side], side);
}

Shares LostInGlass::scaled(const Shares& raw, std::size_t side) const {
    const float refracted = raw.refracted * scale_[side];
    return {raw.sum() - refracted, refracted};
}

Shares LostInGlass::operator()(const Vec3f& w) const {
    const std::size_t s = side(w);
    float t;
    const int i = GlassAxis::cell(std::sqrt(std::abs(w.z)), t);
    return scaled(interpolated(row_, row_fraction_, index_, index_fraction_,
                               [&](const Losses& l) { return between(l.at[s][i], l.at[s][i + 1], t); }),
                  s);
}

float LostInGlass::f_cos(const Vec3f& wo, const Vec3f& wi) const {
    const bool same_side = wo.z * wi.z > 0;
    const float mean = mean_[side(wi)].towards(same_side);
    if (!(mean > 0)) return 0;
    return (*this)(wo).towards(same_side) * (*this)(wi).towards(same_side) / mean * kInvPi * std::abs(wi.z);
}

}  // namespace latent::render
