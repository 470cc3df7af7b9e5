#include "render/bsdf/schlick_albedo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/bsdf/fresnel.h"
#include "render/bsdf/microfacet.h"

namespace latent::render {

namespace {

constexpr int kSize = 32;    // nodes along each axis
constexpr int kStrata = 24;  // squared: facets drawn at each node
constexpr float kMinMu = 1e-3f;

// Parts of E: f0 E0 + f90 E90.
struct Parts {
    float e0 = 0, e90 = 0;
    Parts mixed(const Parts& b, float t) const { return {e0 + (b.e0 - e0) * t, e90 + (b.e90 - e90) * t}; }
};

float node(int i) {
    const float root = static_cast<float>(i) / (kSize - 1);
    return root * root;
}

// The mean over visible facets of what is neither shadowed nor refracted.
Parts integrate(float mu, float alpha) {
    const Microfacets facets = Microfacets::of_alpha(alpha, alpha);
    const Vec3f wo{std::sqrt(1 - mu * mu), 0, mu};
    Parts sum;
    for (int i = 0; i < kStrata * kStrata; ++i) {
        const int row = i / kStrata;
        const float u = (static_cast<float>(i % kStrata) + 0.5f) / kStrata, v = (static_cast<float>(row) + 0.5f) / kStrata;
        const Vec3f m = facets.sample_visible(wo, u, v);
        const float c = dot(wo, m);
        const Vec3f wi = m * (2 * c) - wo;
        if (!(wi.z > 0)) continue;
        const float passes = facets.masking_shadowing(wo, wi) / facets.masking(wo), s = schlick_rise(c);
        sum.e0 += passes * (1 - s);
        sum.e90 += passes * s;
    }
    constexpr float kShare = 1.0f / (kStrata * kStrata);
    return {sum.e0 * kShare, sum.e90 * kShare};
}

struct Table {
    std::array<std::array<Parts, kSize>, kSize> at;  // [alpha][mu]
    std::array<Parts, kSize> mean;                   // of each row, as it is interpolated

    Table() {
        for (int a = 0; a < kSize; ++a) {
            for (int i = 0; i < kSize; ++i) at[a][i] = integrate(std::max(node(i), kMinMu), node(a));
            // Between nodes E is linear in x, mu = x^2: the integral of 4 x^3 E, by Gauss's rule of 3 points, exactly.
            for (int i = 0; i + 1 < kSize; ++i) {
                for (const auto& [t, weight] :
                     {std::pair(0.1127016654f, 5 / 18.0f), {0.5f, 8 / 18.0f}, {0.8872983346f, 5 / 18.0f}}) {
                    const float x = (static_cast<float>(i) + t) / (kSize - 1);
                    const Parts e = at[a][i].mixed(at[a][i + 1], t);
                    const float w = 4 * x * x * x * weight / (kSize - 1);
                    mean[a].e0 += w * e.e0;
                    mean[a].e90 += w * e.e90;
                }
            }
        }
    }
};

const Table& table() {
    static const Table t;
    return t;
}

int cell(float root, float& fraction) {
    const float x = std::clamp(root, 0.0f, 1.0f) * (kSize - 1);
    const int i = std::min(static_cast<int>(x), kSize - 2);
    fraction = x - static_cast<float>(i);
    return i;
}

}  // namespace

SchlickAlbedo::SchlickAlbedo(float f0, float f90, float alpha) : f0_(f0), f90_(f90), row_(cell(std::sqrt(alpha), fraction_)) {
    const Parts e = table().mean[row_].mixed(table().mean[row_ + 1], fraction_);
    mean_ = f0 * e.e0 + f90 * e.e90;
}

float SchlickAlbedo::operator()(float mu) const {
    float t;
    const int i = cell(std::sqrt(mu), t);
    const auto &low = table().at[row_], &high = table().at[row_ + 1];
    const Parts e = low[i].mixed(low[i + 1], t).mixed(high[i].mixed(high[i + 1], t), fraction_);
    return f0_ * e.e0 + f90_ * e.e90;
}

}  // namespace latent::render
