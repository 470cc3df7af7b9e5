// render/spectral/sampled_spectrum.h: one value for each wavelength of a sample, and the arithmetic on them: short loops that the
// compiler vectorises.
#pragma once

#include <cstdint>

namespace latent::render {

// Room for the most wavelengths that a sample can have. Places beyond the sample's k repeat its last wavelength in spectra, so that
// they stay finite, and are zero in the weights that end a path, so that they count for nothing.
inline constexpr std::uint32_t kMaxWavelengths = 32;

// Taken in four parts, whatever the processor. N is a multiple of four.
template <std::uint32_t N>
float max_of(const float (&v)[N]) {
    float part[4] = {v[0], v[1], v[2], v[3]};
    for (std::uint32_t i = 4; i < N; i += 4) {
        for (std::uint32_t j = 0; j < 4; ++j) part[j] = part[j] < v[i + j] ? v[i + j] : part[j];
    }
    const float a = part[0] < part[1] ? part[1] : part[0], b = part[2] < part[3] ? part[3] : part[2];
    return a < b ? b : a;
}

struct alignas(64) SampledSpectrum {
    float v[kMaxWavelengths];

    SampledSpectrum() = default;  // not initialised
    explicit SampledSpectrum(float value) {
        for (float& x : v) x = value;
    }
    float operator[](std::uint32_t i) const { return v[i]; }
    float& operator[](std::uint32_t i) { return v[i]; }

    SampledSpectrum& operator*=(const SampledSpectrum& b) {
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) v[i] *= b.v[i];
        return *this;
    }
    SampledSpectrum& operator*=(float s) {
        for (float& x : v) x *= s;
        return *this;
    }
    SampledSpectrum& operator+=(const SampledSpectrum& b) {
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) v[i] += b.v[i];
        return *this;
    }
    float max() const { return max_of(v); }
    bool is_black() const { return max() <= 0; }  // what is not a number is not black: it must be counted
};

inline SampledSpectrum operator*(const SampledSpectrum& a, const SampledSpectrum& b) {
    SampledSpectrum out;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] = a.v[i] * b.v[i];
    return out;
}
inline SampledSpectrum operator*(const SampledSpectrum& a, float s) {
    SampledSpectrum out;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] = a.v[i] * s;
    return out;
}

// Value i is f(i).
template <class F>
SampledSpectrum spectrum_of(F f) {
    SampledSpectrum out;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] = f(i);
    return out;
}

}  // namespace latent::render
