#include "render/bsdf/conductor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/bsdf/schlick_albedo.h"

namespace latent::render {

// R = ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2).
void Conductor::reflect(const SampledSpectrum& r, SampledSpectra& spectra) {
    SampledSpectrum& eta = spectra.allocate() = SampledSpectrum(1.0f);
    SampledSpectrum& k = spectra.allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        const float limited = std::min(r.v[i], 0.9999f);
        k.v[i] = 2 * std::sqrt(limited) / std::sqrt(1 - limited);
    }
    eta_ = &eta;
    k_ = &k;
}

Conductor Conductor::beneath(const SampledSpectrum& eta, SampledSpectra& spectra) const {
    const auto over_eta = [&](const SampledSpectrum& part) {
        SampledSpectrum& out = spectra.allocate();
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] = part.v[i] / eta.v[i];
        return &out;
    };
    Conductor metal = *this;
    metal.eta_ = over_eta(*eta_);
    metal.k_ = over_eta(*k_);
    return metal;
}

void Conductor::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    const Vec3f w = turned(w_camera);
    Vec3f m;
    if (!half_vector(w, w_light, 1, m)) {
        value = SampledSpectrum(0.0f);
        return;
    }
    value *= fresnel_conductor(abs_dot(w, m), *eta_, *k_);
    value *= facets_.density(m) * facets_.masking_shadowing(w, w_light) / (4 * std::abs(w.z));
    if (!multiscatter_) return;
    const FacetGain gain(facets_.mean_alpha());
    const float gained = gain(std::abs(w.z), std::abs(w_light.z));
    value *= spectrum_of([&](std::uint32_t i) {
        float mean = 0;  // integral of 2 c F(c), by Gauss's rule of 3 points in c^2
        for (const auto& [c, weight] :
             {std::pair(0.3357106870f, 5 / 18.0f), {0.7071067812f, 8 / 18.0f}, {0.9419966408f, 5 / 18.0f}})
            mean += weight * fresnel_conductor(c, eta_->v[i], k_->v[i]);
        return 1 + gain.returned(mean) * gained;
    });
}

float Conductor::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    const Vec3f w = turned(wo);
    Vec3f m;
    return half_vector(w, wi, 1, m) ? facets_.visible_density(w, m) / (4 * abs_dot(w, m)) : 0;
}

bool Conductor::sample(const Vec3f& wo, float, float u, float v, ClosureSample& out, SampledSpectrum& weight) const {
    const Vec3f w = turned(wo);
    if (is_delta()) {
        out.wi = {-w.x, -w.y, w.z};
        out.delta = true;
        out.probability = out.probability_reverse = 1;
        weight *= fresnel_conductor(std::abs(w.z), *eta_, *k_);
        return true;
    }
    const Vec3f m = facets_.sample_visible(w, u, v);
    out.wi = m * (2 * dot(w, m)) - w;
    return out.wi.z * w.z > 0;
}

}  // namespace latent::render
