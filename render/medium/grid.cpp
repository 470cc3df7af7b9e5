#include "render/medium/grid.h"

#include <cmath>

#include "render/math/elementary.h"

namespace latent::render {

namespace {

// Planck's law over its peak, with x = c2 / (lambda T) and x_peak = 4.9651: (x / x_peak)^5 (e^x_peak - 1) / (e^x - 1).
void multiply_blackbody(float kelvin, const Wavelengths& w, SampledSpectrum& value) {
    constexpr float kC2 = 1.438776877e7f;  // nm K
    static const float scale = static_cast<float>(std::expm1(4.965114231744276) / std::pow(4.965114231744276, 5));
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        const float x = kC2 / (w.lambda_nm[i] * kelvin), e = exp_nonpositive(-x), x2 = x * x;
        value.v[i] *= scale * x2 * x2 * x * e / (1 - e);
    }
}

}  // namespace

MajorantGrid UnitGrid::majorants() const {
    // A box of the unit cube becomes a box of voxels about its image.
    const auto max_between = [this](const Vec3f& low, const Vec3f& high) {
        const Affinef& m = grid_from_unit_;
        const Vec3f middle = m.point((low + high) * 0.5f), half = (high - low) * 0.5f;
        const auto reach = [&](float x, float y, float z) {
            return half.x * std::abs(x) + half.y * std::abs(y) + half.z * std::abs(z);
        };
        const Vec3f size{reach(m.x.x, m.y.x, m.z.x), reach(m.x.y, m.y.y, m.z.y), reach(m.x.z, m.y.z, m.z.z)};
        return grid_->max_between(middle - size, middle + size);
    };
    return {MajorantGrid::size_for(grid_->size), max_between, *this};
}

GridMedium::GridMedium(const PhaseFunction& phase, const Affined& medium_from_unit, const Affined& unit_from_world,
                       std::uint32_t sigma_t, std::uint32_t sigma_s, std::uint32_t emission, const GridVolume& volume)
    : ScaledMedium(phase, unit_from_world, sigma_t, sigma_s, UnitGrid(volume.density, medium_from_unit).majorants()),
      emission_(emission),
      density_(volume.density, medium_from_unit),
      temperature_(volume.temperature, medium_from_unit),
      Le_scale_(volume.Le_scale, medium_from_unit),
      temperature_offset_(static_cast<float>(volume.temperature_offset)),
      temperature_scale_(static_cast<float>(volume.temperature_scale)) {}

bool GridMedium::emission(const Vec3f& p, SampleState& sample, SampledSpectrum& out) const {
    const float scale = density_(p) * Le_scale_(p);
    if (!(scale > 0)) return false;
    if (!temperature_) {
        out = sample.spectra[emission_] * scale;
        return true;
    }
    const float kelvin = (temperature_(p) - temperature_offset_) * temperature_scale_;
    if (!(kelvin > 100)) return false;
    out = sample.spectra[emission_] * scale;
    multiply_blackbody(kelvin, sample.spectra.wavelengths, out);
    return true;
}

}  // namespace latent::render
