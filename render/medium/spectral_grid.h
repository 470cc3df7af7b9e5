// render/medium/spectral_grid.h: a grid with spectra of its own at every voxel. docs/rendering.md, "Media".
#pragma once

#include <memory>

#include "render/medium/heterogeneous.h"
#include "render/scene/volume.h"

namespace latent::render {

class SpectralGridMedium final : public HeterogeneousMedium {
 public:
    // `one`: the spectrum that is 1 everywhere. `scale` multiplies sigma_a and sigma_s. `Le` is the spectrum of the library that
    // the Le of the volume multiplies.
    SpectralGridMedium(const PhaseFunction& phase, const Affined& unit_from_world, std::uint32_t one, float scale, std::uint32_t Le,
                       const SpectralVolume& volume);

    bool is_emissive() const override { return volume_.Le != nullptr; }

 protected:
    void extinction(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_t) const override;
    void scattering(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_s) const override;
    bool emission(const Vec3f& p, SampleState& sample, SampledSpectrum& out) const override;

 private:
    float scale_;
    std::uint32_t Le_;
    SpectralVolume volume_;
};

}  // namespace latent::render
