// render/light/light_type.h: the verbs of a light: a point of it as seen from somewhere, a ray that it sends, and the densities of
// both. docs/rendering.md, "Lights".
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

#include "render/bsdf/light_sample_context.h"
#include "render/geometry/geometry.h"
#include "render/light/light_bounds.h"
#include "render/sampling/uniform.h"
#include "render/sampling/warp.h"
#include "render/spectral/spectra.h"

namespace latent::render {

// A point of a light and its geometric normal; 0 at infinity.
struct EmissionPoint {
    Vec3f p{}, ng{};
    Vec2f uv{};           // PrimitivePoint::uv
    bool is_met = false;  // by a ray, which passes through holes; any other point may lie in one
};

// Where a line of sight ends on a light.
struct LightHit {
    Vec3f wi;         // unit, towards the light
    Vec3f p{}, ng{};  // EmissionPoint's; at infinity: p is where it is seen from
    Vec2f uv{};

    EmissionPoint point() const { return {p, ng, uv, true}; }
};

// A point of a light (or a direction to an infinite one), drawn for a point that it lights.
struct LightPoint {
    Interaction at;     // lights that are not infinite
    Vec3f wi;           // unit, towards it
    float distance;     // kInfinity for infinite lights
    float pdf_omega;    // 1/sr at the point that is lit; 1 for a delta light
    float falloff = 1;  // delta lights: 1/d^2, times the spot's profile
    Vec2f uv{};         // EmissionPoint's

    EmissionPoint point() const { return {at.p, at.ng, uv}; }

    // Sets wi and distance from `at`. False: it is where it is seen from.
    bool look_from(const Vec3f& from) {
        const Vec3f to = at.p - from;
        const float d2 = length_squared(to);
        if (!(d2 > 0)) return false;
        distance = std::sqrt(d2);
        wi = to / distance;
        return true;
    }
};

// A ray that a light emits.
struct LightRay {
    Interaction at;       // where it starts: on the light, or on a disk outside of the scene
    Vec3f d;              // unit
    float pdf_position;   // 1/m^2: on the light, or on the disk; 1 for a point
    float pdf_direction;  // 1/sr; 1 for a distant light
    float cosine = 1;     // between d and the light's normal; 1 for points and infinite lights
    float profile = 1;    // spot: its profile
    std::uint32_t medium = kNone;
    Vec2f uv{};  // EmissionPoint's

    EmissionPoint point() const { return {at.p, at.ng, uv}; }
};

// Where a light of a single point stands and what it shines on: all that sampling along a ray needs.
struct PointSource {
    Vec3f p;
    Vec3f axis{};     // a cone's; unit
    float outer = 2;  // 1 - cos of the cone's half angle; 2: every direction

    LightBounds bounds() const {
        LightBounds out = LightBounds::from_ball(Vec3d(p), 0);
        if (outer < 2) out.point(Vec3d(axis), angle_in_turns(1 - outer, std::sqrt(outer * (2 - outer))), 0);
        return out;
    }
    // LightType's, without what varies with direction.
    bool sample_point(const Vec3f& from, LightPoint& out) const {
        out.at = {p, 0, {}};
        if (!out.look_from(from)) return false;
        out.pdf_omega = 1;
        out.falloff = 1 / length_squared(p - from);
        return out.falloff > 0;
    }
};

// What is emitted: `scale` times a spectrum of the library: radiance, or the intensity of a point.
struct Emission {
    std::uint32_t spectrum;
    float scale;

    void multiply(SampledSpectra& spectra, SampledSpectrum& value) const {
        const SampledSpectrum& s = spectra[spectrum];
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) value.v[i] *= s.v[i] * scale;
    }
};

// A light is small and copied freely; what is large (an image) it points to. Any thread.
//
//   kIsInfinite        shines from infinity; only such a light is found by rays that leave the scene
//   kIsDelta           a point or one direction: nothing can hit it by chance
//   emission           `scale` and spectrum, for whoever weighs lights
//   extent             power / (scale x spectrum) [m^2 sr, sr for points]: what of it counts when lights are chosen
//   bounds             of a light that is not infinite: where and which way it shines; but for the intensity
//   sample_point       draws a point for `from`; false: nothing of it can be seen from there
//   pdf_omega          density [1/sr at `from`] with which sample_point ends there; 0 for delta lights
//   sample_ray         draws a ray; u, v for the position, s, t for the direction
//   pdf_position       1/m^2: on an area light, or on the disk of an infinite one; 1 for points
//   pdf_direction      1/sr: of rays in direction d from a point with normal ng; 0 for a single direction
//   multiply_emission  value *= what a point sends in direction d (from the light), without falloff or profile; false: nothing is
//                      ever sent that way, and value is as it was
template <class L>
concept LightType = std::is_trivially_copyable_v<L> &&
    requires(const L& light, const Vec3f& v, const EmissionPoint& at, const LightSampleContext& context, Uniform u,
             const LightHit& hit, LightPoint& point, LightRay& ray, SampledSpectra& spectra, SampledSpectrum& value) {
    { L::kIsInfinite } -> std::convertible_to<bool>;
    { L::kIsDelta } -> std::convertible_to<bool>;
    { light.emission() } -> std::same_as<const Emission&>;
    { light.extent() } -> std::same_as<double>;
    requires L::kIsInfinite || requires {
        { light.bounds() } -> std::same_as<LightBounds>;
    };
    { light.sample_point(v, context, u, u, point) } -> std::same_as<bool>;
    { light.pdf_omega(v, context, hit) } -> std::same_as<float>;
    { light.sample_ray(u, u, u, u, ray) } -> std::same_as<void>;
    { light.pdf_position() } -> std::same_as<float>;
    { light.pdf_direction(v, v) } -> std::same_as<float>;
    { light.multiply_emission(at, v, spectra, value) } -> std::same_as<bool>;
};

}  // namespace latent::render
