// render/medium/medium.h: homogeneous media that absorb and scatter each wavelength differently. docs/rendering.md, "Media".
#pragma once

#include <cstdint>

#include "render/math/elementary.h"
#include "render/medium/phase.h"
#include "render/sampling/uniform.h"
#include "render/scene/description.h"
#include "render/spectral/spectra.h"

namespace latent::render {

struct Medium {
    std::uint32_t sigma_t = 0, sigma_s = 0;  // spectra [1/m]
    PhaseFunction phase;
};

// Farther than any scene; products with it stay finite.
inline constexpr float kFar = 1e30f;

// Distances are drawn in one wavelength, chosen uniformly, and weighed by the mean density over all k: the balance heuristic
// between the k ways to draw one. That mean is the density of the step, whichever subpath took it:
//   a vertex in the medium   p(t) = 1/k sum sigma_t e^(-sigma_t t)    [1/m]
//   passing a length d       P(d) = 1/k sum e^(-sigma_t d)
struct MediumStep {
    bool scattered;
    float t;        // where, if scattered
    float density;  // p(t) or P(d)
    float passing;  // P(t) or P(d)
};

inline float mean_over(const Batch& value, std::uint32_t k) {
    float sum = 0;
    for (std::uint32_t i = 0; i < k; ++i) sum += value[i];
    return sum / static_cast<float>(k);
}

// value *= e^(-sigma_t d); returns P(d).
inline float multiply_transmittance(const Medium& medium, float d, SampledSpectra& spectra, Batch& value) {
    const Batch& sigma_t = spectra[medium.sigma_t];
    const float length = d < kFar ? d : kFar;
    const Batch t = batch_of([&](std::uint32_t i) { return exp_of_negative(-sigma_t.v[i] * length); });
    value *= t;
    return mean_over(t, spectra.wavelengths.k);
}

// p(t) / P(t): turns the odds of passing a stretch into the density of a vertex at its end.
inline float scattering_over_passing(const Medium& medium, float t, SampledSpectra& spectra) {
    const Batch& sigma_t = spectra[medium.sigma_t];
    float scattering = 0, passing = 0;
    for (std::uint32_t i = 0; i < spectra.wavelengths.k; ++i) {
        const float transmittance = exp_of_negative(-sigma_t.v[i] * t);
        scattering += sigma_t.v[i] * transmittance;
        passing += transmittance;
    }
    return scattering / passing;
}

// The line between two vertices, maybe through several media: the odds P of passing all of it, and its stretches at both ends.
struct Line {
    float passing = 1;
    std::uint32_t first_medium = kNone, last_medium = kNone;
    float first_length = 0, last_length = 0;
};

// A vertex after a length t: value *= sigma_s e^(-sigma_t t).
inline MediumStep scatter_at(const Medium& medium, float t, SampledSpectra& spectra, Batch& value) {
    const Batch &sigma_t = spectra[medium.sigma_t], &sigma_s = spectra[medium.sigma_s];
    const Batch transmittance = batch_of([&](std::uint32_t i) { return exp_of_negative(-sigma_t.v[i] * t); });
    value *= transmittance;
    value *= sigma_s;
    const std::uint32_t k = spectra.wavelengths.k;
    return {true, t, mean_over(transmittance * sigma_t, k), mean_over(transmittance, k)};
}

// Draws a step of at most d; value *= its weight: sigma_s e^(-sigma_t t) / p(t), or e^(-sigma_t d) / P(d).
inline MediumStep sample_step(const Medium& medium, float d, Uniform u_wavelength, Uniform u, SampledSpectra& spectra,
                              Batch& value) {
    const float sigma = spectra[medium.sigma_t][u_wavelength.index(spectra.wavelengths.k)];
    const float t = sigma > 0 ? -log_of_complement(u) / sigma : kInfinity;
    if (!(t < d)) {
        const float density = multiply_transmittance(medium, d, spectra, value);
        value *= density > 0 ? 1 / density : 0;
        return {false, d, density, density};
    }
    const MediumStep step = scatter_at(medium, t, spectra, value);
    value *= 1 / step.density;
    return step;
}

}  // namespace latent::render
