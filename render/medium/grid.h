// render/medium/grid.h: a grid of densities that scale the spectra of a medium. docs/rendering.md, "Media".
#pragma once

#include <memory>

#include "render/medium/heterogeneous.h"
#include "render/scene/volume.h"

namespace latent::render {

// A grid as it is met from the unit cube; 1 everywhere if there is none.
class UnitGrid {
 public:
    UnitGrid() = default;
    UnitGrid(const PlacedGrid& placed, const Affined& medium_from_unit)
        : grid_(placed.grid), grid_from_unit_(placed.grid_from_medium * medium_from_unit) {}

    explicit operator bool() const { return grid_ != nullptr; }
    float operator()(const Vec3f& p) const { return grid_ ? (*grid_)(grid_from_unit_.point(p)) : 1; }
    // Cells for the density that the grid holds.
    MajorantGrid majorants() const;

 private:
    std::shared_ptr<const VoxelGrid> grid_;
    Affinef grid_from_unit_;
};

// sigma_t, sigma_s and emission are those spectra of the library times the density at a point. `emission`: sigma_a times the
// radiance emitted, or times its scale where there are temperatures; kNone: none.
class GridMedium final : public ScaledMedium {
 public:
    GridMedium(const PhaseFunction& phase, const Affined& medium_from_unit, const Affined& unit_from_world, std::uint32_t sigma_t,
               std::uint32_t sigma_s, std::uint32_t emission, const GridVolume& volume);

    bool is_emissive() const override { return emission_ != kNone; }
    float density(const Vec3f& p) const override { return density_(p); }
    bool emission(const Vec3f& p, SampleState& sample, SampledSpectrum& out) const override;

 private:
    std::uint32_t emission_;
    UnitGrid density_, temperature_, Le_scale_;
    float temperature_offset_, temperature_scale_;
};

}  // namespace latent::render
