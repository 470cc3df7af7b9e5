// render/bsdf/phase.h: what scatters in media: the phase function of Henyey and Greenstein, and mixtures of it. docs/rendering.md,
// "Media".
#pragma once

#include <array>
#include <cstdint>

#include "render/math/vec.h"
#include "render/scene/description.h"
#include "render/spectral/sampled_spectrum.h"

namespace latent::render {

// Directions point away from the vertex; the same in every wavelength, symmetric, and its own density:
//   p(wo, wi) = (1 - g^2) / (4 pi (1 + g^2 + 2 g cos)^(3/2))  [1/sr],   cos = wo.wi, so that g > 0 favours -1    [HG41]
struct PhaseFunction {
    float g = 0;  // mean cosine of the turn; -1 < g < 1

    float operator()(const Vec3f& wo, const Vec3f& wi) const;
    Vec3f sample(const Vec3f& wo, float u, float v) const;
};

// The phase function of media that share a place: each scatters its share of the light, which varies with wavelength.
//   p(wo, wi) = sum share_i p_i(wo, wi),   its density: the same with the mean shares
struct PhaseMixture {
    struct Part {
        PhaseFunction phase;
        float mean = 0;
        const SampledSpectrum* share = nullptr;
    };
    std::uint32_t count = 0;
    std::array<Part, kMaxSummed> parts;
};

// One of both.
struct Phase {
    PhaseFunction single{};
    const PhaseMixture* mixture = nullptr;

    Phase() = default;
    Phase(const PhaseFunction& phase) : single(phase) {}
    explicit Phase(const PhaseMixture& of) : mixture(&of) {}

    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const { return mixture ? mixed_pdf(wo, wi) : single(wo, wi); }
    // value *= p(wo, wi)
    void multiply(const Vec3f& wo, const Vec3f& wi, SampledSpectrum& value) const {
        if (mixture) return multiply_mixed(wo, wi, value);
        value *= single(wo, wi);
    }
    // `u_part` chooses the part of a mixture.
    Vec3f sample(const Vec3f& wo, float u_part, float u, float v) const {
        return mixture ? part(u_part).sample(wo, u, v) : single.sample(wo, u, v);
    }

 private:
    float mixed_pdf(const Vec3f& wo, const Vec3f& wi) const;
    void multiply_mixed(const Vec3f& wo, const Vec3f& wi, SampledSpectrum& value) const;
    const PhaseFunction& part(float u) const;
};

}  // namespace latent::render
