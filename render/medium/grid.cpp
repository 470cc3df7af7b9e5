#include "render/medium/grid.h"

namespace latent::render {

namespace {

MajorantGrid majorants_of(const VoxelGrid& density, const Affinef& density_from_unit) {
    // A box of the unit cube becomes a box of voxels about its image.
    const auto max_between = [&](const Vec3f& low, const Vec3f& high) {
        const Vec3f middle = density_from_unit.point((low + high) * 0.5f), half = (high - low) * 0.5f;
        const auto reach = [&](float x, float y, float z) {
            return half.x * std::abs(x) + half.y * std::abs(y) + half.z * std::abs(z);
        };
        const Affinef& m = density_from_unit;
        const Vec3f size{reach(m.x.x, m.y.x, m.z.x), reach(m.x.y, m.y.y, m.z.y), reach(m.x.z, m.y.z, m.z.z)};
        return density.max_between(middle - size, middle + size);
    };
    const auto at = [&](const Vec3f& p) { return density(density_from_unit.point(p)); };
    return {MajorantGrid::size_for(density.size), max_between, at};
}

}  // namespace

GridMedium::GridMedium(const PhaseFunction& phase, const Affined& medium_from_unit, const Affined& unit_from_world,
                       std::uint32_t sigma_t, std::uint32_t sigma_s, const GridVolume& volume)
    : HeterogeneousMedium(phase, unit_from_world, sigma_t,
                          majorants_of(*volume.density, Affinef(volume.density_from_medium * medium_from_unit))),
      sigma_t_(sigma_t),
      sigma_s_(sigma_s),
      density_(volume.density),
      density_from_unit_(volume.density_from_medium * medium_from_unit) {}

void GridMedium::extinction(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_t) const {
    sigma_t = sample.spectra[sigma_t_] * density(p);
}

void GridMedium::scattering(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_s) const {
    sigma_s = sample.spectra[sigma_s_] * density(p);
}

bool GridMedium::emission(const Vec3f&, SampleState&, SampledSpectrum&) const { return false; }

}  // namespace latent::render
