// render/medium/sum.h: media that are in the same place, at least one of which varies there. docs/rendering.md, "Media".
#pragma once

#include <memory>
#include <vector>

#include "render/medium/heterogeneous.h"

namespace latent::render {

// Its coefficients are the sums of those of its parts.
class SumMedium final : public HeterogeneousMedium {
 public:
    struct Part {
        std::unique_ptr<const HeterogeneousMedium> varied;  // null: the same everywhere
        Affined unit_from_world{};                          // the box of `varied` becomes the unit cube
        float max_sigma_t = 0, mean_sigma_t = 0;            // over all wavelengths, at density 1
        // For a medium that is the same everywhere: spectra of the library. `emission` may be kNone.
        std::uint32_t sigma_t = 0, sigma_s = 0, emission = kNone;
        PhaseFunction phase;
    };
    // At most kMaxSummed parts. `one`: the spectrum that is 1 everywhere.
    SumMedium(std::vector<Part> parts, std::uint32_t one);

    std::optional<Box> box() const override { return is_bounded_ ? HeterogeneousMedium::box() : std::nullopt; }
    bool is_emissive() const override { return is_emissive_; }
    Phase phase(const Vec3f& p, SampleState& sample) const override;

    void extinction(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_t) const override;
    void scattering(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_s) const override;
    bool emission(const Vec3f& p, SampleState& sample, SampledSpectrum& out) const override;

 private:
    // `box`: that all parts lie in which vary.
    SumMedium(std::vector<Part>&& parts, std::uint32_t one, const Box& box);
    // Calls visit(part, p) with p in the unit cube of each part that is there.
    template <class Visit>
    void each_at(const Vec3f& p, Visit visit) const;
    // Sums a coefficient over the parts: `constant` of those that are the same everywhere, `varied` of the others.
    using Coefficient = void (HeterogeneousMedium::*)(const Vec3f&, SampleState&, SampledSpectrum&) const;
    void add_up(const Vec3f& p, SampleState& sample, std::uint32_t Part::*constant, Coefficient varied, SampledSpectrum& sum) const;

    struct Placed {
        Part part;
        Affinef unit_from_sum;
    };
    std::vector<Placed> parts_;
    bool is_bounded_ = true, is_emissive_ = false;
};

}  // namespace latent::render
