// render/texture/procedural.h: textures computed from a point. docs/scenes.md, "Textures".
#pragma once

#include "render/texture/combine.h"
#include "render/texture/mapping.h"
#include "render/texture/noise.h"
#include "render/texture/rgb_spectrum.h"

namespace latent::render {

// Weight of the second colour of a checkerboard whose cells are unit squares or cubes, the first at the origin: integrated against
// a triangle filter along each axis, 1.5 times as wide on each side as the footprint.
float checkerboard(const TextureCoordinates& c);
float checkerboard(const SpacePoint& c);
// Whether (s, t) lies in a dot: one of radius 0.35 in about half of the unit cells around whole numbers, somewhere inside.
bool inside_dot(Vec2f st);
// Linear RGB of marble's veins at phase t in [0,1]: a spline through greys.
std::array<float, 3> marble_colour(float t);

template <class Value>
class Checkerboard final : public Texture<Value> {
 public:
    Checkerboard(const MappingDescription& mapping, bool is_solid, const Source<Value>& a, const Source<Value>& b)
        : plane_(mapping), space_(mapping), is_solid_(is_solid), of_{a, b} {}
    Value at(const TexturePoint& point) const override {
        return blend<Value>(of_, is_solid_ ? checkerboard(space_(point)) : checkerboard(plane_(point)), point);
    }

 private:
    Mapping plane_;
    SpaceMapping space_;
    bool is_solid_;
    Source<Value> of_[2];
};

template <class Value>
class Dots final : public Texture<Value> {
 public:
    Dots(const MappingDescription& mapping, const Source<Value>& inside, const Source<Value>& outside)
        : mapping_(mapping), inside_(inside), outside_(outside) {}
    Value at(const TexturePoint& point) const override {
        return value_of<Value>(inside_dot(mapping_(point).st) ? inside_ : outside_, point);
    }

 private:
    Mapping mapping_;
    Source<Value> inside_, outside_;
};

// Between values at the corners of the unit square; beyond it the same plane of each edge goes on.
template <class Value>
class Bilerp final : public Texture<Value> {
 public:
    Bilerp(const MappingDescription& mapping, const Source<Value>& v00, const Source<Value>& v01, const Source<Value>& v10,
           const Source<Value>& v11)
        : mapping_(mapping), v00_(v00), v01_(v01), v10_(v10), v11_(v11) {}
    Value at(const TexturePoint& point) const override {
        const Vec2f st = mapping_(point).st;
        const Value low = mixed(value_of<Value>(v00_, point), value_of<Value>(v10_, point), st.x, point),
                    high = mixed(value_of<Value>(v01_, point), value_of<Value>(v11_, point), st.x, point);
        return mixed(low, high, st.y, point);
    }

 private:
    Mapping mapping_;
    Source<Value> v00_, v01_, v10_, v11_;
};

// The first where the normal is parallel to a direction, the second where it is square to it.
template <class Value>
class DirectionMix final : public Texture<Value> {
 public:
    DirectionMix(const Vec3f& direction, const Source<Value>& along, const Source<Value>& across)
        : direction_(direction), of_{across, along} {}
    Value at(const TexturePoint& point) const override {
        return blend<Value>(of_, std::min(abs_dot(point.n, direction_), 1.0f), point);
    }

 private:
    Vec3f direction_;
    Source<Value> of_[2];
};

enum class NoiseKind : std::uint8_t { kFbm, kWrinkled, kWindy, kVeins, kWood, kClouds };
class Noise final : public FloatTexture {
 public:
    Noise(NoiseKind kind, const MappingDescription& mapping, float omega, int octaves, float scale, float variation)
        : kind_(kind), mapping_(mapping), omega_(omega), octaves_(octaves), scale_(scale), variation_(variation) {}
    float at(const TexturePoint& point) const override;

 private:
    float disturbed(float x, const SpacePoint& at) const { return x + variation_ * fractal_noise(at, omega_, octaves_); }

    NoiseKind kind_;
    SpaceMapping mapping_;
    float omega_;
    int octaves_;
    float scale_, variation_;
};

class Marble final : public SpectrumTexture {
 public:
    Marble(const MappingDescription& mapping, float omega, int octaves, float scale, float variation, const RgbColors& colors)
        : mapping_(mapping), omega_(omega), octaves_(octaves), scale_(scale), variation_(variation), colors_(colors) {}
    const SampledSpectrum* at(const TexturePoint& point) const override;

 private:
    SpaceMapping mapping_;
    float omega_;
    int octaves_;
    float scale_, variation_;
    RgbColors colors_;
};

}  // namespace latent::render
