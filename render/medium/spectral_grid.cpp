#include "render/medium/spectral_grid.h"

#include <algorithm>
#include <cmath>

#include "color/rgb_to_spectrum.h"

namespace latent::render {

namespace {

// The largest and the mean value of each voxel's sigma_t over all wavelengths, as grids.
struct Extinction {
    VoxelGrid max, mean;
};
Extinction extinction_of(const SpectralVolume& volume, float scale) {
    const SpectralVoxels& any = volume.sigma_a ? *volume.sigma_a : *volume.sigma_s;
    Extinction out{VoxelGrid::of_size(any.size), VoxelGrid::of_size(any.size)};
    const auto [nx, ny, nz] = any.size;
    for (std::size_t n = 0; n < any.spectra.size(); ++n) {
        float max = 0, mean = 0;
        for (const SpectralVoxels* voxels : {volume.sigma_a.get(), volume.sigma_s.get()}) {
            if (voxels == nullptr) {
                max += 1, mean += 1;
                continue;
            }
            const auto& [c0, c1, c2, height] = voxels->spectra[n];
            if (voxels->is_basis) {
                max += std::max({c0, c1, c2});
                mean += (c0 + c1 + c2) / 3;
                continue;
            }
            const color::SigmoidSpectrum spectrum{c0, c1, c2, height};
            max += spectrum.max_value();
            constexpr int kPoints = 8;
            for (int i = 0; i < kPoints; ++i) mean += spectrum(400 + 300 * (static_cast<float>(i) + 0.5f) / kPoints) / kPoints;
        }
        const auto i = static_cast<std::uint32_t>(n % nx), j = static_cast<std::uint32_t>(n / nx % ny),
                   k = static_cast<std::uint32_t>(n / nx / ny);
        out.max.set(i, j, k, max * scale);
        out.mean.set(i, j, k, mean * scale);
    }
    return out;
}

MajorantGrid majorants_of(const SpectralVolume& volume, float scale) {
    const Extinction extinction = extinction_of(volume, scale);
    const auto& size = extinction.max.size;
    const Vec3f n{static_cast<float>(size[0]), static_cast<float>(size[1]), static_cast<float>(size[2])};
    const auto voxel = [&](const Vec3f& p) { return Vec3f{p.x * n.x - 0.5f, p.y * n.y - 0.5f, p.z * n.z - 0.5f}; };
    // What is 1 everywhere does not fall to zero at the faces of the box, as voxels do.
    const float everywhere = (volume.sigma_a ? 0 : scale) + (volume.sigma_s ? 0 : scale);
    const auto max_between = [&](const Vec3f& low, const Vec3f& high) {
        return std::max(extinction.max.max_between(voxel(low), voxel(high)), everywhere) * (1 + 1e-6f);
    };
    return {MajorantGrid::size_for(size), max_between, [&](const Vec3f& p) { return extinction.mean(voxel(p)); }};
}

}  // namespace

SpectralGridMedium::SpectralGridMedium(const PhaseFunction& phase, const Affined& unit_from_world, std::uint32_t one, float scale,
                                       std::uint32_t Le, const std::array<std::uint32_t, 3>& basis, const SpectralVolume& volume)
    : HeterogeneousMedium(phase, unit_from_world, one, majorants_of(volume, scale)),
      scale_(scale),
      Le_(Le),
      basis_(basis),
      volume_(volume) {}

void SpectralGridMedium::add_at(const SpectralVoxels& voxels, const Vec3f& p, float factor, SampleState& sample,
                                SampledSpectrum& out) const {
    const Wavelengths& w = sample.spectra.wavelengths;
    const float x[3] = {p.x, p.y, p.z};
    std::int64_t first[3];
    float fraction[3];
    for (int a = 0; a < 3; ++a) {
        const float at = x[a] * static_cast<float>(voxels.size[a]) - 0.5f, below = std::floor(at);
        first[a] = static_cast<std::int64_t>(below);
        fraction[a] = at - below;
    }
    for (int n = 0; n < 8; ++n) {
        std::int64_t index = 0;
        float weight = factor;
        bool exists = true;
        for (int a = 2; a >= 0; --a) {
            const int upper = n >> a & 1;
            const std::int64_t i = first[a] + upper, size = voxels.size[a];
            exists &= i >= 0 && i < size;
            index = index * size + i;
            weight *= upper != 0 ? fraction[a] : 1 - fraction[a];
        }
        if (!exists || weight == 0) continue;
        const auto& [c0, c1, c2, scale] = voxels.spectra[static_cast<std::size_t>(index)];
        if (scale == 0) continue;
        if (voxels.is_basis) {
            const SampledSpectrum &r = sample.spectra[basis_[0]], &g = sample.spectra[basis_[1]], &b = sample.spectra[basis_[2]];
            for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] += weight * (c0 * r.v[i] + c1 * g.v[i] + c2 * b.v[i]);
            continue;
        }
        weight *= scale;
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            const float t = (w.lambda_nm[i] - 595) * (1 / 235.0f);  // [JH19]
            const float y = (c0 * t + c1) * t + c2;
            out.v[i] += weight * (0.5f + 0.5f * y / std::sqrt(1 + y * y));
        }
    }
}

void SpectralGridMedium::add_sigma(const std::shared_ptr<const SpectralVoxels>& voxels, const Vec3f& p, SampleState& sample,
                                   SampledSpectrum& out) const {
    if (voxels) {
        add_at(*voxels, p, scale_, sample, out);
    } else {
        out += SampledSpectrum(scale_);
    }
}

void SpectralGridMedium::extinction(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_t) const {
    sigma_t = SampledSpectrum(0.0f);
    add_sigma(volume_.sigma_a, p, sample, sigma_t);
    add_sigma(volume_.sigma_s, p, sample, sigma_t);
}

void SpectralGridMedium::scattering(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_s) const {
    sigma_s = SampledSpectrum(0.0f);
    add_sigma(volume_.sigma_s, p, sample, sigma_s);
}

bool SpectralGridMedium::emission(const Vec3f& p, SampleState& sample, SampledSpectrum& out) const {
    SampledSpectrum Le(0.0f);
    add_at(*volume_.Le, p, 1, sample, Le);
    if (Le.is_black()) return false;
    out = SampledSpectrum(0.0f);
    add_sigma(volume_.sigma_a, p, sample, out);
    out *= Le * sample.spectra[Le_];
    return true;
}

}  // namespace latent::render
