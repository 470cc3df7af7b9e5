// render/medium/spectral_grid.h: a grid with spectra of its own at every voxel. docs/rendering.md, "Media".
#pragma once

#include <array>
#include <memory>

#include "render/medium/heterogeneous.h"
#include "render/scene/volume.h"

namespace latent::render {

class SpectralGridMedium final : public HeterogeneousMedium {
 public:
    // `one`: the spectrum that is 1 everywhere. `scale` multiplies sigma_a and sigma_s. `Le` is the spectrum of the library that
    // the Le of the volume multiplies.
    // `basis`: color::rgb_basis() in the library.
    SpectralGridMedium(const PhaseFunction& phase, const Affined& unit_from_world, std::uint32_t one, float scale, std::uint32_t Le,
                       const std::array<std::uint32_t, 3>& basis, const SpectralVolume& volume);

    bool is_emissive() const override { return volume_.Le != nullptr; }
    void extinction(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_t) const override;
    void scattering(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_s) const override;
    bool emission(const Vec3f& p, SampleState& sample, SampledSpectrum& out) const override;

 private:
    // out += factor times the spectrum at p: linear between voxels, zero outside.
    void add_at(const SpectralVoxels& voxels, const Vec3f& p, float factor, SampleState& sample, SampledSpectrum& out) const;
    // A coefficient at p, 1 everywhere if the scene gives none.
    void add_sigma(const std::shared_ptr<const SpectralVoxels>& voxels, const Vec3f& p, SampleState& sample,
                   SampledSpectrum& out) const;

    float scale_;
    std::uint32_t Le_;
    std::array<std::uint32_t, 3> basis_;
    SpectralVolume volume_;
};

}  // namespace latent::render
