// render/sampling/sample_state.h: a sample on its way through the scene.
#pragma once

#include <cstdint>
#include <optional>

#include "render/sampling/random.h"
#include "render/sampling/sampler.h"
#include "render/spectral/spectra.h"

namespace latent::render {

// Its numbers, its wavelengths and the one it keeps where it is dispersed, and its time. Used by one thread, which draws from
// `random` in the same order each time.
struct SampleState {
    SampleNumbers numbers;
    SampledSpectra& spectra;
    std::uint32_t kept;
    std::optional<Random> randoms{};  // begun when first asked: most samples need none
    float time = 0;                   // for all motions: from 0, their start, to 1
    std::uint64_t shadow_rays = 0;    // tests of visibility between two points so far

    Uniform random() {
        if (!randoms) randoms.emplace(numbers(Dimension::kRandom).bits);
        return (*randoms)();
    }
    std::uint32_t k() const { return spectra.wavelengths.k; }
};

}  // namespace latent::render
