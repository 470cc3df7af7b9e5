#include "render/medium/homogeneous.h"

#include <algorithm>

#include "render/math/elementary.h"
#include "render/medium/phase_mixer.h"

namespace latent::render {

Phase HomogeneousMedium::phase(const Vec3f& p, SampleState& sample) const {
    if (parts_.empty()) return Medium::phase(p, sample);
    PhaseMixer mixer(sample);
    for (const Part& part : parts_) mixer.add(part.phase, sample.spectra[part.sigma_s]);
    return mixer.phase();
}

MediumStep HomogeneousMedium::sample_step(const Segment& segment, Uniform u_wavelength, Uniform u, SampleState& sample,
                                          SampledSpectrum& value, SampledSpectrum* emitted) const {
    if (emitted != nullptr) add_emission(segment.length, sample, value, *emitted);
    const float sigma = sample.spectra[sigma_t_][u_wavelength.index(sample.k())];
    const float t = sigma > 0 ? -log_one_minus(u) / sigma : kInfinity;
    const bool scattered = t < segment.length;
    const MediumStep step = scattered ? scatter_at(segment, t, sample, value) : multiply_transmittance(segment, sample, value);
    value *= scattered || step.density > 0 ? 1 / step.density : 0;
    return step;
}

// The integral of sigma_a Le e^(-sigma_t t) over the whole segment.
void HomogeneousMedium::add_emission(float length, SampleState& sample, const SampledSpectrum& value,
                                     SampledSpectrum& emitted) const {
    const SampledSpectrum &sigma_t = sample.spectra[sigma_t_], &emission = sample.spectra[emission_];
    const float d = std::min(length, kFar);
    emitted += value * emission * spectrum_of([&](std::uint32_t i) {
                   const float depth = sigma_t.v[i] * d;
                   return depth < 1e-3f ? d * (1 - 0.5f * depth) : (1 - exp_nonpositive(-depth)) / sigma_t.v[i];
               });
}

MediumStep HomogeneousMedium::scatter_at(const Segment&, float t, SampleState& sample, SampledSpectrum& value) const {
    const SampledSpectrum &sigma_t = sample.spectra[sigma_t_], &sigma_s = sample.spectra[sigma_s_];
    const SampledSpectrum transmittance = spectrum_of([&](std::uint32_t i) { return exp_nonpositive(-sigma_t.v[i] * t); });
    value *= transmittance;
    value *= sigma_s;
    return {true, t, mean_over(transmittance * sigma_t, sample.k()), mean_over(transmittance, sample.k()), t};
}

MediumStep HomogeneousMedium::multiply_transmittance(const Segment& segment, SampleState& sample, SampledSpectrum& value) const {
    const SampledSpectrum& sigma_t = sample.spectra[sigma_t_];
    const float length = std::min(segment.length, kFar);
    const SampledSpectrum transmittance = spectrum_of([&](std::uint32_t i) { return exp_nonpositive(-sigma_t.v[i] * length); });
    value *= transmittance;
    const float mean = mean_over(transmittance, sample.k());
    return {false, length, mean, mean, length};
}

float HomogeneousMedium::scattering_over_transmittance(const Vec3f&, float column, SampleState& sample) const {
    const SampledSpectrum& sigma_t = sample.spectra[sigma_t_];
    float scattering = 0, transmitted = 0;
    for (std::uint32_t i = 0; i < sample.k(); ++i) {
        const float transmittance = exp_nonpositive(-sigma_t.v[i] * column);
        scattering += sigma_t.v[i] * transmittance;
        transmitted += transmittance;
    }
    return scattering / transmitted;
}

}  // namespace latent::render
