// render/texture/combine.h: textures made of other textures, the same for numbers and spectra.
#pragma once

#include "render/texture/texture.h"

namespace latent::render {

template <class Value>
struct SourceOf;
template <>
struct SourceOf<float> {
    using Type = FloatSource;
    static float value(const FloatSource& source, const TexturePoint& point) { return source.at(point); }
};
template <>
struct SourceOf<const SampledSpectrum*> {
    using Type = SpectrumSource;
    static const SampledSpectrum* value(const SpectrumSource& source, const TexturePoint& point) { return &source.at(point); }
};
template <class Value>
using Source = typename SourceOf<Value>::Type;
template <class Value>
Value value_of(const Source<Value>& source, const TexturePoint& point) {
    return SourceOf<Value>::value(source, point);
}

inline float scaled(float a, float factor, const TexturePoint&) { return a * factor; }
inline const SampledSpectrum* scaled(const SampledSpectrum* a, float factor, const TexturePoint& point) {
    return &(point.spectra->allocate() = *a * factor);
}
// (1 - t) a + t b
inline float mixed(float a, float b, float t, const TexturePoint&) { return (1 - t) * a + t * b; }
inline const SampledSpectrum* mixed(const SampledSpectrum* a, const SampledSpectrum* b, float t, const TexturePoint& point) {
    SampledSpectrum& out = point.spectra->allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] = (1 - t) * a->v[i] + t * b->v[i];
    return &out;
}

template <class Value>
class Constant final : public Texture<Value> {
 public:
    explicit Constant(const Source<Value>& value) : value_(value) {}
    Value at(const TexturePoint& point) const override { return value_of<Value>(value_, point); }

 private:
    Source<Value> value_;
};

template <class Value>
class Scale final : public Texture<Value> {
 public:
    Scale(const Source<Value>& value, const FloatSource& factor) : value_(value), factor_(factor) {}
    Value at(const TexturePoint& point) const override { return scaled(value_of<Value>(value_, point), factor_.at(point), point); }

 private:
    Source<Value> value_;
    FloatSource factor_;
};

// 1 where a value reaches the threshold, 0 elsewhere.
class Threshold final : public FloatTexture {
 public:
    Threshold(const FloatSource& value, const FloatSource& threshold) : value_(value), threshold_(threshold) {}
    float at(const TexturePoint& point) const override { return value_.at(point) >= threshold_.at(point) ? 1 : 0; }

 private:
    FloatSource value_, threshold_;
};

// Two textures by a weight of the second; neither is evaluated where it has none.
template <class Value>
Value blend(const Source<Value> (&of)[2], float t, const TexturePoint& point) {
    if (t == 0) return value_of<Value>(of[0], point);
    if (t == 1) return value_of<Value>(of[1], point);
    const Value a = value_of<Value>(of[0], point);
    return mixed(a, value_of<Value>(of[1], point), t, point);
}

template <class Value>
class Mix final : public Texture<Value> {
 public:
    Mix(const Source<Value>& a, const Source<Value>& b, const FloatSource& amount) : of_{a, b}, amount_(amount) {}
    Value at(const TexturePoint& point) const override { return blend<Value>(of_, amount_.at(point), point); }

 private:
    Source<Value> of_[2];
    FloatSource amount_;
};

}  // namespace latent::render
