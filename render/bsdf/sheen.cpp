#include "render/bsdf/sheen.h"

#include <algorithm>
#include <cmath>

#include "render/math/elementary.h"
#include "render/sampling/warp.h"

namespace latent::render {
namespace {

float exponential(float x) { return x > 0 ? 1 / exp_nonpositive(-x) : exp_nonpositive(x); }

// Lambda of [EstevezKulla17]: exp(L(x)) with L(x) = a / (1 + b x^c) + d x + e up to x = 1/2, and mirrored there.
float lambda(float cosine, float alpha) {
    const float t = (1 - alpha) * (1 - alpha);
    const auto between = [&](float rough, float smooth) { return rough + t * (smooth - rough); };
    const float a = between(21.5473f, 25.3245f), b = between(3.82987f, 3.32435f), c = between(0.19823f, 0.16801f),
                d = between(-1.97760f, -1.27393f), e = between(-4.32054f, -4.85967f);
    const auto l = [&](float x) { return a / (1 + b * exp_nonpositive(c * log_positive(std::max(x, 1e-7f)))) + d * x + e; };
    return exponential(cosine < 0.5f ? l(cosine) : 2 * l(0.5f) - l(1 - cosine));
}

// D G / (4 cos cos) of directions on one side.
float fibres(const Vec3f& a, const Vec3f& b, float alpha) {
    const Vec3f h = normalize(a + b);
    const float sin2 = std::clamp(1 - h.z * h.z, 1e-12f, 1.0f), ca = std::abs(a.z), cb = std::abs(b.z);
    const float d = (2 + 1 / alpha) * 0.5f * kInvPi * exp_nonpositive(0.5f * log_positive(sin2) / alpha);
    return d / ((1 + lambda(ca, alpha) + lambda(cb, alpha)) * 4 * ca * cb);
}

// Albedo of the fibres: nodes at the squares of i / (kNodes - 1), of mu and of alpha.
constexpr int kNodes = 24;
class FibreAlbedo {
 public:
    FibreAlbedo() {
        for (int a = 0; a < kNodes; ++a) {
            for (int i = 0; i < kNodes; ++i) at_[a][i] = integral(std::max(node(i), 1e-3f), std::max(node(a), Sheen::kMinAlpha));
        }
    }
    float operator()(float mu, float alpha) const {
        const float x = std::sqrt(std::min(mu, 1.0f)) * (kNodes - 1), y = std::sqrt(alpha) * (kNodes - 1);
        const int i = std::min(static_cast<int>(x), kNodes - 2), a = std::min(static_cast<int>(y), kNodes - 2);
        const float s = x - static_cast<float>(i), t = y - static_cast<float>(a);
        const auto row = [&](int k) { return at_[k][i] + s * (at_[k][i + 1] - at_[k][i]); };
        return row(a) + t * (row(a + 1) - row(a));
    }

 private:
    static float node(int i) {
        const float root = static_cast<float>(i) / (kNodes - 1);
        return root * root;
    }
    // By cosines z = t^2, the middles of strata.
    static float integral(float mu, float alpha) {
        constexpr int kSteps = 48;
        const Vec3f wo{std::sqrt(1 - mu * mu), 0, mu};
        double sum = 0;
        for (int i = 0; i < kSteps * kSteps; ++i) {
            const float t = (static_cast<float>(i / kSteps) + 0.5f) / kSteps,
                        turns = (static_cast<float>(i % kSteps) + 0.5f) / kSteps / 2;
            const float z = t * t;
            sum += static_cast<double>(fibres(wo, direction_at(z, turns), alpha) * z * 2 * t);
        }
        return static_cast<float>(std::min(sum * static_cast<double>(2 * kPi) / (kSteps * kSteps), 1.0));
    }
    float at_[kNodes][kNodes];
};
float albedo_of_fibres(float mu, float alpha) {
    static const FibreAlbedo table;
    return table(mu, alpha);
}

}  // namespace

Sheen::Sheen(const Values<Sheen>& v)
    : Sheen(State{MetallicRoughness(v.of<MetallicRoughness>()).with_facets(), &v.spectrum("sheen.color"),
                  v.number("sheen.roughness") * v.number("sheen.roughness")}) {}

Sheen::Sheen(const State& state) : state_(state), alpha_(std::max(state.alpha, kMinAlpha)) {
    const float most = state.color->max();
    sheen_probability_ = most > 0 ? std::clamp(0.5f * most / (most + state.base.albedo().max()), 0.1f, 0.5f) : 0;
}

void Sheen::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    SampledSpectrum base(1.0f);
    state_.base.multiply_f_cos(w_camera, w_light, base);
    const float s = w_camera.z * w_light.z > 0 ? fibres(w_camera, w_light, alpha_) * std::abs(w_light.z) : 0;
    const float e = std::max(albedo_of_fibres(std::abs(w_camera.z), alpha_), albedo_of_fibres(std::abs(w_light.z), alpha_));
    const SampledSpectrum& color = *state_.color;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) value.v[i] *= color.v[i] * s + (1 - color.v[i] * e) * base.v[i];
}

float Sheen::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    return sheen_probability_ * kInvPi * std::max(std::copysign(wi.z, wo.z * wi.z), 0.0f) +
           (1 - sheen_probability_) * state_.base.pdf_omega(wo, wi);
}

bool Sheen::sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const {
    if (u_lobe >= sheen_probability_)
        return state_.base.sample(wo, std::min((u_lobe - sheen_probability_) / (1 - sheen_probability_), 1 - 0x1p-24f), u, v, out,
                                  weight);
    out.wi = sample_cosine_hemisphere(u, v);
    if (wo.z < 0) out.wi.z = -out.wi.z;
    return out.wi.z * wo.z > 0;
}

}  // namespace latent::render
