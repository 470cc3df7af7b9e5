// render/medium/values.h: one value of a medium for each wavelength, or for each level of its spectrum.
#pragma once

#include <algorithm>
#include <cstdint>

#include "render/spectral/sampled_spectrum.h"

namespace latent::render {

// N is a multiple of four. Sums are of four parts, whatever the processor.
template <std::uint32_t N>
struct MediumValues {
    float v[N];

    MediumValues() = default;  // not initialised
    explicit MediumValues(float value) { std::fill_n(v, N, value); }
    float operator[](std::uint32_t i) const { return v[i]; }

    MediumValues& operator*=(const MediumValues& b) {
        for (std::uint32_t i = 0; i < N; ++i) v[i] *= b.v[i];
        return *this;
    }
    float sum() const {
        float part[4] = {v[0], v[1], v[2], v[3]};
        for (std::uint32_t i = 4; i < N; i += 4) {
            for (std::uint32_t j = 0; j < 4; ++j) part[j] += v[i + j];
        }
        return (part[0] + part[1]) + (part[2] + part[3]);
    }
    float max() const { return max_of(v); }
};

template <std::uint32_t N, class F>
MediumValues<N> values_of(F f) {
    MediumValues<N> out;
    for (std::uint32_t i = 0; i < N; ++i) out.v[i] = f(i);
    return out;
}
template <std::uint32_t N>
MediumValues<N> operator*(const MediumValues<N>& a, const MediumValues<N>& b) {
    return values_of<N>([&](std::uint32_t i) { return a.v[i] * b.v[i]; });
}

}  // namespace latent::render
