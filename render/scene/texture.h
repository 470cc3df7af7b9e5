// render/scene/texture.h: values that vary over surfaces, as a scene describes them. Conventions are pbrt-v4's (docs/scenes.md).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "color/spectrum.h"
#include "render/math/vec.h"
#include "render/scene/source_location.h"

namespace latent::render {

// A parameter: the value, unless a texture gives it (an index into SceneDescription::textures).
struct FloatInput {
    float value = 0;
    std::uint32_t texture = kNone;

    FloatInput() = default;
    FloatInput(float constant) : value(constant) {}
    bool is_textured() const { return texture != kNone; }
};
struct SpectrumInput {
    color::Spectrum value{};
    std::uint32_t texture = kNone;

    SpectrumInput() = default;
    SpectrumInput(color::Spectrum constant) : value(std::move(constant)) {}
    bool is_textured() const { return texture != kNone; }
};

// What a spectrum is, and so what an rgb means: within [0,1] at every wavelength, or of any magnitude.
enum class SpectrumRole : std::uint8_t { kReflectance, kUnbounded };

// From a point of a surface to the coordinates (s, t) of a texture, or to a point of texture space.
enum class MappingKind : std::uint8_t { kUv, kSpherical, kCylindrical, kPlanar };
struct MappingDescription {
    MappingKind kind = MappingKind::kUv;
    double scale_u = 1, scale_v = 1;  // uv
    double delta_u = 0, delta_v = 0;  // uv, planar
    Vec3d v1{1, 0, 0}, v2{0, 1, 0};   // planar
    Affined texture_from_world{};     // of places counted from SceneDescription::origin
};

enum class TextureKind : std::uint8_t { kConstant, kScale, kMix };

// One of the kinds; each uses the fields that name it. Inputs of a float texture are `numbers`, of a spectrum texture `spectra`;
// a texture that is used in two roles is two.
struct TextureDescription {
    TextureKind kind = TextureKind::kConstant;
    bool is_spectrum = false;
    SpectrumRole role = SpectrumRole::kReflectance;  // of a spectrum texture
    std::array<FloatInput, 2> numbers{};             // constant, scale: the first; mix: both
    std::array<SpectrumInput, 2> spectra{};          // the same
    FloatInput amount{};                             // scale: the factor; mix: of the second
    MappingDescription mapping{};
    SourceLocation location{};
};

}  // namespace latent::render
