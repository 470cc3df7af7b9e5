#include "render/bsdf/schlick_albedo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/bsdf/facet_tables.h"
#include "render/bsdf/fresnel.h"

namespace latent::render {

namespace {

constexpr int kSize = 32;      // nodes along each axis
constexpr int kFacets = 1024;  // drawn at each node, by a lattice: where they stop to reflect upwards is a step in both numbers
using Axis = RootAxis<kSize>;

// Parts of E: f0 E0 + f90 E90.
struct SchlickParts {
    float e0 = 0, e90 = 0;
    SchlickParts mixed(const SchlickParts& b, float t) const { return {e0 + (b.e0 - e0) * t, e90 + (b.e90 - e90) * t}; }
    void add(const SchlickParts& b, float times) { e0 += b.e0 * times, e90 += b.e90 * times; }
    static SchlickParts of_facet(float c) { return {1 - schlick_rise(c), schlick_rise(c)}; }
};
// With a gain: g, and the parts of E that it makes.
struct GainParts {
    float gain = 0;
    SchlickParts e{};
    GainParts mixed(const GainParts& b, float t) const { return {gain + (b.gain - gain) * t, e.mixed(b.e, t)}; }
    void add(const GainParts& b, float times) { gain += b.gain * times, e.add(b.e, times); }
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

// f(c, mu of wi, share) for visible facets: what is neither shadowed nor refracted.
template <class F>
void for_facets(float mu, float alpha, const F& f) {
    const Microfacets facets = Microfacets::of_alpha(alpha, alpha);
    const Vec3f wo{std::sqrt(1 - mu * mu), 0, mu};
    for_visible_facets(facets, wo, kFacets, [&](const Vec3f& m) {
        const float c = dot(wo, m);
        const Vec3f wi = m * (2 * c) - wo;
        if (wi.z > 0) f(c, wi.z, 1.0f / kFacets * facets.masking_shadowing(wo, wi) / facets.masking(wo));
    });
}

template <class Parts>
using Row = std::array<Parts, kSize>;  // at each mu

template <class Parts>
Row<Parts> row(float alpha) {
    Row<Parts> out;
    for (int i = 0; i < kSize; ++i)
        for_facets(Axis::cosine(i), alpha, [&](float c, float, float share) { out[i].add(Parts::of_facet(c), share); });
    return out;
}

// g with g[i] sum_j shares[i][j] g[j] = 1 [SinkhornKnopp67]. Each round takes the geometric mean of the last g and of that which
// would do.
Row<float> balance(const Row<Row<float>>& shares) {
    constexpr int kRounds = 20;
    Row<float> g, next;
    g.fill(1);
    for (int n = 0; n < kRounds; ++n) {
        for (int i = 0; i < kSize; ++i) {
            float sum = 0;
            for (int j = 0; j < kSize; ++j) sum += shares[i][j] * g[j];
            next[i] = std::sqrt(g[i] / sum);
        }
        g = next;
    }
    return g;
}

template <>
Row<GainParts> row<GainParts>(float alpha) {
    Row<Row<SchlickParts>> from{};  // [mu of wo][mu of wi], between two nodes in both
    Row<Row<float>> shares{};
    for (int i = 0; i < kSize; ++i) {
        for_facets(Axis::cosine(i), alpha, [&](float c, float mu, float share) {
            float t;
            const int j = Axis::cell(std::sqrt(mu), t);
            from[i][j].add(SchlickParts::of_facet(c), share * (1 - t));
            from[i][j + 1].add(SchlickParts::of_facet(c), share * t);
        });
        for (int j = 0; j < kSize; ++j) shares[i][j] = from[i][j].e0 + from[i][j].e90;
    }
    const Row<float> gain = balance(shares);
    Row<GainParts> out;
    for (int i = 0; i < kSize; ++i) {
        out[i].gain = gain[i];
        for (int j = 0; j < kSize; ++j) out[i].e.add(from[i][j], gain[i] * gain[j]);
    }
    return out;
}

template <class Parts>
struct Table {
    Row<Row<Parts>> at;  // [alpha][mu]
    Row<Parts> mean;     // each row's mean, as it is interpolated

    Table() {
        for (int a = 0; a < kSize; ++a) {
            at[a] = row<Parts>(Axis::node(a));
            Axis::for_mean([&](int i, float t, float weight) { mean[a].add(at[a][i].mixed(at[a][i + 1], t), weight); });
        }
    }
};

template <class Parts>
const Table<Parts>& table() {
    static const Table<Parts> t;
    return t;
}

// E at mu, between the rows of two alphas.
template <class Parts>
Parts interpolated(float mu, int row, float fraction) {
    float t;
    const int i = Axis::cell(std::sqrt(mu), t);
    const auto &low = table<Parts>().at[row], &high = table<Parts>().at[row + 1];
    return low[i].mixed(low[i + 1], t).mixed(high[i].mixed(high[i + 1], t), fraction);
}

}  // namespace

SchlickAlbedo::SchlickAlbedo(float f0, float f90, float alpha, bool multiscatter)
    : f0_(f0), f90_(f90), row_(Axis::cell(std::sqrt(alpha), fraction_)) {
    const Table<SchlickParts>& all = table<SchlickParts>();
    const SchlickParts e = all.mean[row_].mixed(all.mean[row_ + 1], fraction_);
    mean_ = f0 * e.e0 + f90 * e.e90;
    if (!multiscatter) return;
    returned_ = FacetGain(alpha).returned(schlick_mean(f0, f90));
    const Table<GainParts>& gained = table<GainParts>();
    const SchlickParts whole = gained.mean[row_].mixed(gained.mean[row_ + 1], fraction_).e;
    mean_ += returned_ * (f0 * whole.e0 + f90 * whole.e90 - mean_);
}

float SchlickAlbedo::operator()(float mu) const {
    const SchlickParts parts = interpolated<SchlickParts>(mu, row_, fraction_);
    const float e = f0_ * parts.e0 + f90_ * parts.e90;
    if (returned_ == 0) return e;
    const SchlickParts whole = interpolated<GainParts>(mu, row_, fraction_).e;
    return e + returned_ * (f0_ * whole.e0 + f90_ * whole.e90 - e);
}

FacetGain::FacetGain(float alpha) : mean_(SchlickAlbedo(1, 1, alpha).mean()), row_(Axis::cell(std::sqrt(alpha), fraction_)) {}

float FacetGain::at(float mu) const { return interpolated<GainParts>(mu, row_, fraction_).gain; }

float FacetWeights::node(int j) {
    const float root = static_cast<float>(j) / (kNodes - 1);
    return root * root;
}

FacetWeights FacetWeights::at(float mu, float alpha) {
    float fraction;
    const int row = Axis::cell(std::sqrt(alpha), fraction);
    return interpolated<NodeParts>(mu, row, fraction).sum;
}

FacetWeights FacetWeights::mean(float alpha) {
    float fraction;
    const int row = Axis::cell(std::sqrt(alpha), fraction);
    const Table<NodeParts>& all = table<NodeParts>();
    return all.mean[row].mixed(all.mean[row + 1], fraction).sum;
}

}  // namespace latent::render
