// render/spectral/levels.h: the few different values that a spectrum has at the wavelengths of a sample, if they are few.
#pragma once

#include <cstdint>

#include "render/spectral/sampled_spectrum.h"

namespace latent::render {

// Grey media have one value, and those whose spectra end within the visible range have two: most work on 28 wavelengths is then
// work on these. Places from `count` on repeat the last value, and no wavelength belongs to them.
struct SpectrumLevels {
    static constexpr std::uint32_t kMax = 4;

    std::uint32_t count = 0;  // 0: they are not few, and nothing below is set
    float value[kMax];
    float share[kMax];                     // for each of the k wavelengths
    const SampledSpectrum* members[kMax];  // 1 for the wavelengths of a level, 0 for all others and from k on

    // `allocate` returns room for the members.
    template <class Allocate>
    static SpectrumLevels of(const SampledSpectrum& spectrum, std::uint32_t k, Allocate allocate) {
        SpectrumLevels levels;
        std::uint32_t count = 0, level_of[kMaxWavelengths];
        for (std::uint32_t i = 0; i < k; ++i) {
            std::uint32_t level = 0;
            while (level < count && levels.value[level] != spectrum.v[i]) ++level;
            if (level == kMax) return levels;
            if (level == count) levels.value[count++] = spectrum.v[i];
            level_of[i] = level;
        }
        for (std::uint32_t level = 0; level < kMax; ++level) {
            levels.share[level] = 0;
            levels.members[level] = nullptr;
            if (level >= count) {
                levels.value[level] = levels.value[count - 1];
                continue;
            }
            SampledSpectrum& members = allocate();
            members = SampledSpectrum(0.0f);
            for (std::uint32_t i = 0; i < k; ++i) {
                if (level_of[i] != level) continue;
                members.v[i] = 1;
                levels.share[level] += 1 / static_cast<float>(k);
            }
            levels.members[level] = &members;
        }
        levels.count = count;
        return levels;
    }
};

}  // namespace latent::render
