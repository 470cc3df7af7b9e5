// render/medium/homogeneous.h: the same everywhere, so that all has a closed form. docs/rendering.md, "Media".
#pragma once

#include <vector>

#include "render/medium/medium.h"

namespace latent::render {

// Distances are drawn in one wavelength, chosen uniformly, and weighed by the mean density over all k: the balance heuristic
// between the k ways to draw one.
//   a vertex in the medium   p(t) = 1/k sum sigma_t e^(-sigma_t t)    [1/m]
//   passing a length d       P(d) = 1/k sum e^(-sigma_t d)
class HomogeneousMedium final : public Medium {
 public:
    // A part that scatters by a phase function of its own.
    struct Part {
        PhaseFunction phase;
        std::uint32_t sigma_s;
    };
    // Spectra of the scene's library [1/m]; `emission`: sigma_a times the emitted radiance, kNone: none.
    HomogeneousMedium(std::uint32_t sigma_t, std::uint32_t sigma_s, std::uint32_t emission, const PhaseFunction& phase)
        : Medium(phase), sigma_t_(sigma_t), sigma_s_(sigma_s), emission_(emission) {}
    // The sum of several, of which these are the parts; at most kMaxSummed.
    HomogeneousMedium(std::uint32_t sigma_t, std::uint32_t sigma_s, std::uint32_t emission, std::vector<Part> parts)
        : HomogeneousMedium(sigma_t, sigma_s, emission, PhaseFunction{}) {
        parts_ = std::move(parts);
    }

    std::optional<Box> box() const override { return std::nullopt; }
    bool is_emissive() const override { return emission_ != kNone; }
    Phase phase(const Vec3f& p, SampleState& sample) const override;
    MediumStep sample_step(const Segment& segment, Uniform u_wavelength, Uniform u, SampleState& sample, SampledSpectrum& value,
                           SampledSpectrum* emitted) const override;
    MediumStep scatter_at(const Segment& segment, float t, SampleState& sample, SampledSpectrum& value) const override;
    MediumStep multiply_transmittance(const Segment& segment, SampleState& sample, SampledSpectrum& value) const override;
    float scattering_over_transmittance(const Vec3f& p, float column, SampleState& sample) const override;

 private:
    void add_emission(float length, SampleState& sample, const SampledSpectrum& value, SampledSpectrum& emitted) const;

    std::uint32_t sigma_t_, sigma_s_, emission_;
    std::vector<Part> parts_{};  // if there are several
};

}  // namespace latent::render
