// render/medium/phase_mixer.h: the phase function of several media in one place.
#pragma once

#include "render/bsdf/phase.h"
#include "render/medium/medium.h"

namespace latent::render {

// What is added lives as long as the sample.
class PhaseMixer {
 public:
    explicit PhaseMixer(SampleState& sample) : sample_(sample) {}

    // Scatters sigma_s [1/m] by `phase`; those with the same g are one.
    void add(const PhaseFunction& phase, const SampledSpectrum& sigma_s) {
        std::uint32_t i = 0;
        while (i < mixture_.count && mixture_.parts[i].phase.g != phase.g) ++i;
        if (i == mixture_.count) {
            mixture_.parts[i].phase = phase;
            sigma_[i] = &sample_.spectra.allocate();
            *sigma_[i] = SampledSpectrum(0.0f);
            ++mixture_.count;
        }
        *sigma_[i] += sigma_s;
        total_ += sigma_s;
    }

    Phase phase() {
        if (mixture_.count <= 1) return mixture_.parts[0].phase;
        for (std::uint32_t i = 0; i < mixture_.count; ++i) {
            // Where nothing scatters in some wavelength, its shares do not matter: they are those of equal parts.
            const auto even = 1 / static_cast<float>(mixture_.count);
            SampledSpectrum& share = *sigma_[i];
            for (std::uint32_t j = 0; j < kMaxWavelengths; ++j) share.v[j] = total_.v[j] > 0 ? share.v[j] / total_.v[j] : even;
            mixture_.parts[i].mean = mean_over(share, sample_.k());
            mixture_.parts[i].share = &share;
        }
        return Phase(sample_.spectra.store(mixture_));
    }

 private:
    SampleState& sample_;
    PhaseMixture mixture_;
    std::array<SampledSpectrum*, kMaxSummed> sigma_{};
    SampledSpectrum total_{0.0f};
};

}  // namespace latent::render
