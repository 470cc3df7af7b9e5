#include "render/bsdf/schlick_albedo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/bsdf/fresnel.h"
#include "render/bsdf/microfacet.h"

namespace latent::render {

namespace {

constexpr int kSize = 32;      // nodes along each axis
constexpr int kFacets = 1024;  // drawn at each node, by a lattice: where they stop to reflect upwards is a step in both numbers
constexpr float kMinMu = 1e-3f;

// Parts of E: f0 E0 + f90 E90.
struct SchlickParts {
    float e0 = 0, e90 = 0;
    SchlickParts mixed(const SchlickParts& b, float t) const { return {e0 + (b.e0 - e0) * t, e90 + (b.e90 - e90) * t}; }
    void add(const SchlickParts& b, float times) { e0 += b.e0 * times, e90 += b.e90 * times; }
    static SchlickParts of_facet(float c) { return {1 - schlick_rise(c), schlick_rise(c)}; }
};
// Or by nodes.
struct NodeParts {
    FacetWeights sum{};
    NodeParts mixed(const NodeParts& b, float t) const {
        NodeParts out = *this;
        for (std::size_t j = 0; j < sum.weight.size(); ++j) out.sum.weight[j] += (b.sum.weight[j] - sum.weight[j]) * t;
        return out;
    }
    void add(const NodeParts& b, float times) {
        for (std::size_t j = 0; j < sum.weight.size(); ++j) sum.weight[j] += b.sum.weight[j] * times;
    }
    // Lagrange's cubic through the four nodes about c.
    static NodeParts of_facet(float c) {
        constexpr int kLast = FacetWeights::kNodes - 1;
        const float x = std::sqrt(std::min(c, 1.0f)) * kLast;
        const int j = std::clamp(static_cast<int>(x), 1, kLast - 2);
        const float t = x - static_cast<float>(j), before = t + 1, after = t - 1, far = t - 2;
        const float weights[] = {-t * after * far / 6, before * after * far / 2, -before * t * far / 2, before * t * after / 6};
        NodeParts out;
        const auto first = out.sum.weight.begin() + j - 1;
        std::copy(std::begin(weights), std::end(weights), first);
        return out;
    }
};

float node(int i) {
    const float root = static_cast<float>(i) / (kSize - 1);
    return root * root;
}

// The mean over visible facets of what is neither shadowed nor refracted.
template <class Parts>
Parts integrate(float mu, float alpha) {
    const Microfacets facets = Microfacets::of_alpha(alpha, alpha);
    const Vec3f wo{std::sqrt(1 - mu * mu), 0, mu};
    Parts sum;
    constexpr float kShare = 1.0f / kFacets, kGolden = 0.618033989f;
    for (int i = 0; i < kFacets; ++i) {
        const float u = (static_cast<float>(i) + 0.5f) * kShare, turns = static_cast<float>(i) * kGolden,
                    v = turns - std::floor(turns);
        const Vec3f m = facets.sample_visible(wo, u, v);
        const float c = dot(wo, m);
        const Vec3f wi = m * (2 * c) - wo;
        if (!(wi.z > 0)) continue;
        sum.add(Parts::of_facet(c), kShare * facets.masking_shadowing(wo, wi) / facets.masking(wo));
    }
    return sum;
}

template <class Parts>
struct Table {
    std::array<std::array<Parts, kSize>, kSize> at;  // [alpha][mu]
    std::array<Parts, kSize> mean;                   // of each row, as it is interpolated

    Table() {
        for (int a = 0; a < kSize; ++a) {
            for (int i = 0; i < kSize; ++i) at[a][i] = integrate<Parts>(std::max(node(i), kMinMu), node(a));
            // Between nodes E is linear in x, mu = x^2: the integral of 4 x^3 E, by Gauss's rule of 3 points, exactly.
            for (int i = 0; i + 1 < kSize; ++i) {
                for (const auto& [t, weight] :
                     {std::pair(0.1127016654f, 5 / 18.0f), {0.5f, 8 / 18.0f}, {0.8872983346f, 5 / 18.0f}}) {
                    const float x = (static_cast<float>(i) + t) / (kSize - 1);
                    mean[a].add(at[a][i].mixed(at[a][i + 1], t), 4 * x * x * x * weight / (kSize - 1));
                }
            }
        }
    }
};

template <class Parts>
const Table<Parts>& table() {
    static const Table<Parts> t;
    return t;
}

int cell(float root, float& fraction) {
    const float x = std::clamp(root, 0.0f, 1.0f) * (kSize - 1);
    const int i = std::min(static_cast<int>(x), kSize - 2);
    fraction = x - static_cast<float>(i);
    return i;
}

// E at mu, between the rows of two alphas.
template <class Parts>
Parts interpolated(float mu, int row, float fraction) {
    float t;
    const int i = cell(std::sqrt(mu), t);
    const auto &low = table<Parts>().at[row], &high = table<Parts>().at[row + 1];
    return low[i].mixed(low[i + 1], t).mixed(high[i].mixed(high[i + 1], t), fraction);
}

}  // namespace

SchlickAlbedo::SchlickAlbedo(float f0, float f90, float alpha) : f0_(f0), f90_(f90), row_(cell(std::sqrt(alpha), fraction_)) {
    const Table<SchlickParts>& all = table<SchlickParts>();
    const SchlickParts e = all.mean[row_].mixed(all.mean[row_ + 1], fraction_);
    mean_ = f0 * e.e0 + f90 * e.e90;
}

float SchlickAlbedo::operator()(float mu) const {
    const SchlickParts e = interpolated<SchlickParts>(mu, row_, fraction_);
    return f0_ * e.e0 + f90_ * e.e90;
}

float FacetWeights::node(int j) {
    const float root = static_cast<float>(j) / (kNodes - 1);
    return root * root;
}

FacetWeights FacetWeights::at(float mu, float alpha) {
    float fraction;
    const int row = cell(std::sqrt(alpha), fraction);
    return interpolated<NodeParts>(mu, row, fraction).sum;
}

FacetWeights FacetWeights::mean(float alpha) {
    float fraction;
    const int row = cell(std::sqrt(alpha), fraction);
    const Table<NodeParts>& all = table<NodeParts>();
    return all.mean[row].mixed(all.mean[row + 1], fraction).sum;
}

}  // namespace latent::render
