// render/scene/texture.h: values that vary over surfaces, as a scene describes them. Conventions are pbrt-v4's (docs/scenes.md).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "base/hash.h"
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
    std::uint32_t uv_set = 0;                // uv: 0 for MeshDescription::uvs, i for more_uvs[i - 1]
    std::array<double, 2> s{1, 0}, t{0, 1};  // uv: (s, t) = (s . (u, v), t . (u, v)) + delta
    double delta_u = 0, delta_v = 0;         // uv, planar
    Vec3d v1{1, 0, 0}, v2{0, 1, 0};          // planar
    Affined texture_from_world{};            // places are counted from SceneDescription::origin
};

enum class TextureWrap : std::uint8_t { kRepeat, kBlack, kClamp, kMirror, kOctahedralSphere };
enum class TextureFilter : std::uint8_t { kPoint, kBilinear, kTrilinear, kEwa, kQuartic };

// A picture, which stays in its file.
struct PictureDescription {
    std::string path{};
    std::string name{};                 // in messages: the place where the scene names it, and its path
    Hash128 content{};                  // hash of the file
    std::array<TextureWrap, 2> wrap{};  // along s and t; kOctahedralSphere: both
    TextureFilter filter = TextureFilter::kBilinear;
    double max_anisotropy = 8;  // ewa
    bool is_srgb = true;        // integers of the file; else x^gamma
    double gamma = 1;
    double scale = 1;
    bool invert = false;         // 1 - scale x
    std::uint8_t channel = 255;  // that a number is; 254: the largest of R, G, B; 255: their mean, or alpha if it varies
};

enum class TextureKind : std::uint8_t {
    kConstant,
    kScale,
    kMix,
    kThreshold,
    kImage,        // a picture
    kVertexColor,  // the colours of a mesh's vertices; white where it has none
    kNormalMap,    // a picture that is no number and no spectrum
    kCheckerboard,
    kDots,
    kBilerp,
    kDirectionMix,
    kFbm,
    kWrinkled,
    kWindy,
    kMarble,
    kVeins,
    kWood,
    kClouds
};

// One of the kinds; each uses the fields that name it. Inputs of a float texture are `numbers`, of a spectrum texture `spectra`;
// a texture that is used in two roles is two.
struct TextureDescription {
    TextureKind kind = TextureKind::kConstant;
    bool is_spectrum = false;
    SpectrumRole role = SpectrumRole::kReflectance;  // for a spectrum texture
    // constant, scale, threshold: the first; mix, checkerboard, directionmix: two; dots: inside, outside; bilerp: v00 v01 v10 v11
    std::array<FloatInput, 4> numbers{};
    std::array<SpectrumInput, 4> spectra{};
    FloatInput amount{};                     // scale: the factor; mix: of the second; threshold: from which on it is 1, not 0
    MappingDescription mapping{};            // for those that depend on the place
    PictureDescription picture{};            // image
    std::array<double, 4> tint{1, 1, 1, 1};  // image, vertexcolor: factors of R, G, B and alpha, before they become a spectrum
    bool by_vertex_color = false;            // image: times the colours of the vertices, too
    bool is_solid = false;                   // checkerboard: of cubes
    Vec3d direction{0, 1, 0};                // directionmix: unit
    std::uint32_t octaves = 8;               // fbm, wrinkled, marble, veins, wood, clouds
    double roughness = 0.5;                  // the same: weight of an octave over that before it
    double scale = 1, variation = 0.2;       // marble, veins, wood, clouds
    SourceLocation location{};
};

}  // namespace latent::render
