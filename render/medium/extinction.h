// render/medium/extinction.h: sigma_t of a medium that varies in space, in as many values as tracking has to follow.
#pragma once

#include <algorithm>
#include <cstdint>

#include "render/math/elementary.h"
#include "render/medium/heterogeneous.h"
#include "render/medium/values.h"

namespace latent::render {

// A value for each wavelength, of any medium.
class SampledExtinction {
 public:
    static constexpr std::uint32_t N = kMaxWavelengths;

    SampledExtinction(const HeterogeneousMedium& medium, std::uint32_t reference, SampleState& sample)
        : medium_(medium), sample_(sample), reference_(sample.spectra[reference]) {}

    // At a point of the unit cube; that point stays the one of multiply_scattering.
    MediumValues<N> at(const Vec3f& p) {
        p_ = p;
        SampledSpectrum sigma_t;
        medium_.extinction(p, sample_, sigma_t);
        return values_of<N>([&](std::uint32_t i) { return sigma_t.v[i]; });
    }
    // value *= sigma_s
    void multiply_scattering(SampledSpectrum& value) const {
        SampledSpectrum sigma_s;
        medium_.scattering(p_, sample_, sigma_s);
        value *= sigma_s;
    }

    float reference_max() const { return reference_.max(); }
    MediumValues<N> model_transmittance(float column) const {
        return values_of<N>([&](std::uint32_t i) { return exp_nonpositive(-reference_.v[i] * column); });
    }
    // Over the k wavelengths.
    float mean(const MediumValues<N>& values) const { return sum_of_k(values).sum() / static_cast<float>(sample_.k()); }
    // Sums and maxima over the k wavelengths of a throughput.
    MediumValues<N> sums(const SampledSpectrum& value) const { return sum_of_k(value); }
    MediumValues<N> maxima(const SampledSpectrum& value) const { return sum_of_k(value); }
    void multiply(const MediumValues<N>& factor, SampledSpectrum& value) const {
        for (std::uint32_t i = 0; i < N; ++i) value.v[i] *= factor.v[i];
    }

 private:
    template <class T>
    MediumValues<N> sum_of_k(const T& value) const {
        return values_of<N>([&, k = sample_.k()](std::uint32_t i) { return i < k ? value.v[i] : 0; });
    }

    const HeterogeneousMedium& medium_;
    SampleState& sample_;
    const SampledSpectrum& reference_;
    Vec3f p_;
};

// A value for each level of the spectrum that the density of a medium scales.
class ScaledExtinction {
 public:
    static constexpr std::uint32_t N = SpectrumLevels::kMax;

    ScaledExtinction(const ScaledMedium& medium, const SpectrumLevels& levels, SampleState& sample)
        : medium_(medium), sample_(sample), levels_(levels) {}

    MediumValues<N> at(const Vec3f& p) {
        density_ = medium_.density(p);
        return values_of<N>([&](std::uint32_t i) { return levels_.value[i] * density_; });
    }
    void multiply_scattering(SampledSpectrum& value) const { value *= sample_.spectra[medium_.sigma_s()] * density_; }

    float reference_max() const { return *std::max_element(levels_.value, levels_.value + N); }
    MediumValues<N> model_transmittance(float column) const {
        return values_of<N>([&](std::uint32_t i) { return exp_nonpositive(-levels_.value[i] * column); });
    }
    float mean(const MediumValues<N>& values) const {
        return values_of<N>([&](std::uint32_t i) { return levels_.share[i] * values.v[i]; }).sum();
    }
    MediumValues<N> sums(const SampledSpectrum& value) const {
        return each([](const MediumValues<kMaxWavelengths>& own) { return own.sum(); }, value);
    }
    MediumValues<N> maxima(const SampledSpectrum& value) const {
        return each([](const MediumValues<kMaxWavelengths>& own) { return own.max(); }, value);
    }
    void multiply(const MediumValues<N>& factor, SampledSpectrum& value) const {
        if (levels_.count == 1) {
            value *= factor.v[0];
            return;
        }
        SampledSpectrum all = *levels_.members[0] * factor.v[0];
        for (std::uint32_t level = 1; level < levels_.count; ++level) all += *levels_.members[level] * factor.v[level];
        value *= all;
    }

 private:
    // Calls f for each level with the values of its wavelengths; the others are zeros.
    template <class F>
    MediumValues<N> each(F f, const SampledSpectrum& value) const {
        MediumValues<N> out(0.0f);
        for (std::uint32_t level = 0; level < levels_.count; ++level) {
            const SampledSpectrum& member = *levels_.members[level];
            out.v[level] = f(values_of<kMaxWavelengths>([&](std::uint32_t i) { return member.v[i] * value.v[i]; }));
        }
        return out;
    }

    const ScaledMedium& medium_;
    SampleState& sample_;
    const SpectrumLevels& levels_;
    float density_ = 0;
};

}  // namespace latent::render
