// render/medium/grid.h: a grid of densities that scale two spectra. docs/rendering.md, "Media".
#pragma once

#include <memory>

#include "render/medium/heterogeneous.h"
#include "render/scene/volume.h"

namespace latent::render {

// sigma_t and sigma_s are the spectra times the density.
class GridMedium final : public HeterogeneousMedium {
 public:
    GridMedium(const PhaseFunction& phase, const Affined& medium_from_unit, const Affined& unit_from_world, std::uint32_t sigma_t,
               std::uint32_t sigma_s, const GridVolume& volume);

    bool is_emissive() const override { return false; }

 protected:
    void extinction(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_t) const override;
    void scattering(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_s) const override;
    bool emission(const Vec3f& p, SampleState& sample, SampledSpectrum& out) const override;

 private:
    float density(const Vec3f& p) const { return (*density_)(density_from_unit_.point(p)); }

    std::uint32_t sigma_t_, sigma_s_;
    std::shared_ptr<const VoxelGrid> density_;
    Affinef density_from_unit_;
};

}  // namespace latent::render
