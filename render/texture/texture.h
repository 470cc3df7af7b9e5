// render/texture/texture.h: a value that varies over surfaces: a number, or a spectrum at the wavelengths of a sample.
// docs/rendering.md, "Textures".
#pragma once

#include "render/math/vec.h"
#include "render/scene/among_vertices.h"
#include "render/spectral/spectra.h"

namespace latent::render {

// The point of a surface that a texture is evaluated at. Nothing depends on the path that came there, so that both subpaths of a
// bidirectional path find the same surface.
struct TexturePoint {
    Vec3f p;
    Vec3f n;  // shading normal, unit
    Vec2f uv;
    Vec3f dpdx, dpdy;    // the footprint: what the point stands for is an ellipse with these as its axes
    Vec2f duvdx, duvdy;  // the same in uv
    AmongVertices vertices{};
    SampledSpectra* spectra = nullptr;  // for spectra alone
};

// Any thread. A spectrum lives as long as the sample of TexturePoint::spectra.
template <class Value>
class Texture {
 public:
    virtual ~Texture() = default;
    virtual Value at(const TexturePoint& point) const = 0;
};
using FloatTexture = Texture<float>;
using SpectrumTexture = Texture<const SampledSpectrum*>;

// A parameter ready to be evaluated: a constant (of spectra: an index into the library), unless a texture gives it.
struct FloatSource {
    float value = 0;
    const FloatTexture* texture = nullptr;

    float at(const TexturePoint& point) const { return texture ? texture->at(point) : value; }
};
struct SpectrumSource {
    std::uint32_t spectrum = 0;
    const SpectrumTexture* texture = nullptr;

    const SampledSpectrum& at(const TexturePoint& point) const {
        return texture ? *texture->at(point) : (*point.spectra)[spectrum];
    }
};

}  // namespace latent::render
