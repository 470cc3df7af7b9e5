// render/material/values.h: parameters of materials at a point. What a texture gives may be anything: each of these is the nearest
// value that makes sense, and of no number the least.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/texture/texture.h"

namespace latent::render {

// Of a texture's values, the nearest within low..high.
inline const SampledSpectrum& within(const SpectrumSource& source, float low, float high, const TexturePoint& point) {
    const SampledSpectrum& given = source.at(point);
    if (source.texture == nullptr) return given;
    SampledSpectrum& out = point.spectra->allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] = given.v[i] > low ? std::min(given.v[i], high) : low;
    return out;
}
inline float within(const FloatSource& source, float low, float high, const TexturePoint& point) {
    if (source.texture == nullptr) return source.value;
    const float given = source.at(point);
    return given > low ? std::min(given, high) : low;
}

inline const SampledSpectrum& reflectance(const SpectrumSource& source, const TexturePoint& point) {
    return within(source, 0, 1, point);
}
// The nearest values within [0,1] to the multiple.
inline const SampledSpectrum& scaled(const SpectrumSource& source, float factor, const TexturePoint& point) {
    const SampledSpectrum& given = source.at(point);
    if (source.texture == nullptr && factor == 1) return given;
    SampledSpectrum& out = point.spectra->allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        const float x = factor * given.v[i];
        out.v[i] = x > 0 ? std::min(x, 1.0f) : 0;
    }
    return out;
}
// Within [0,1], constants too.
inline float fraction(const FloatSource& source, const TexturePoint& point) {
    const float x = source.at(point);
    return x > 0 ? std::min(x, 1.0f) : 0;
}
// GGX alpha.
inline float alpha(const FloatSource& source, bool remap, const TexturePoint& point) {
    const float roughness = within(source, 0, 1e6f, point);
    return remap && source.texture ? std::sqrt(roughness) : roughness;
}

}  // namespace latent::render
