// render/bsdf/fresnel.h: reflectance of smooth interfaces. Unpolarised light. docs/rendering.md, "Surfaces".
#pragma once

#include <algorithm>
#include <cmath>

#include "render/math/vec.h"
#include "render/spectral/sampled_spectrum.h"

namespace latent::render {

// Dielectric whose index of refraction is `eta` times that of the side of the ray, which arrives at cosine c > 0.
//   r_par = (eta c - c_t) / (eta c + c_t),  r_perp = (c - eta c_t) / (c + eta c_t),  F = (r_par^2 + r_perp^2) / 2
// 1 where Snell's law has no transmitted direction (total reflection).
inline float fresnel_dielectric(float c, float eta) {
    const float sin2_t = std::max(0.0f, 1 - c * c) / (eta * eta);
    if (sin2_t >= 1) return 1;
    const float ct = std::sqrt(1 - sin2_t);
    const float parallel = (eta * c - ct) / (eta * c + ct), perpendicular = (c - eta * ct) / (c + eta * ct);
    return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

// Conductor of complex index eta + i k at cosine c of the angle of incidence [Lagarde13]:
//   2 a^2 = sqrt((eta^2 - k^2 - s^2)^2 + 4 eta^2 k^2) + eta^2 - k^2 - s^2,   s = sin, a^2 + b^2 = that square root
//   R_perp = (a^2 + b^2 - 2 a c + c^2) / (a^2 + b^2 + 2 a c + c^2)
//   R_par = R_perp (c^2 (a^2 + b^2) - 2 a c s^2 + s^4) / (c^2 (a^2 + b^2) + 2 a c s^2 + s^4)
inline float fresnel_conductor(float c, float eta, float k) {
    const float c2 = c * c, s2 = std::max(0.0f, 1 - c2);
    const float n2 = eta * eta, k2 = k * k;
    const float t = n2 - k2 - s2;
    const float a2b2 = std::sqrt(t * t + 4 * n2 * k2);
    const float a2 = 0.5f * (a2b2 + t);
    const float a = std::sqrt(a2 > 0 ? a2 : 0.0f);
    const float perpendicular = (a2b2 + c2 - 2 * a * c) / (a2b2 + c2 + 2 * a * c);
    const float p = c2 * a2b2 + s2 * s2, q = 2 * a * c * s2;
    return 0.5f * perpendicular * (1 + (p - q) / (p + q));
}
inline SampledSpectrum fresnel_conductor(float c, const SampledSpectrum& eta, const SampledSpectrum& k) {
    return spectrum_of([&](std::uint32_t i) { return fresnel_conductor(c, eta.v[i], k.v[i]); });
}

// (1 - c)^5: how far Schlick's reflectance at cosine c has risen from that of straight incidence to that of grazing [Schlick94].
inline float schlick_rise(float c) {
    const float x = 1 - std::min(c, 1.0f), x2 = x * x;
    return x2 * x2 * x;
}

// The mean of Schlick's reflectance, f0 to f90: integral of 2 c F(c).
inline float schlick_mean(float f0, float f90) { return f0 + (f90 - f0) / 21; }

// Direction that `w` (towards the light or the camera, on the side of unit normal n) is refracted to, `eta` the index of the other
// side over that of w's side. False: total reflection.
inline bool refract(const Vec3f& w, const Vec3f& n, float eta, Vec3f& out) {
    const float c = dot(w, n);
    const float sin2_t = std::max(0.0f, 1 - c * c) / (eta * eta);
    if (sin2_t >= 1) return false;
    out = n * (c / eta - std::sqrt(1 - sin2_t)) - w / eta;
    return true;
}

}  // namespace latent::render
