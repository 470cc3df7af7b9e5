// render/bsdf/closure.h: the verbs of a closure: what one kind of surface does to light, at the wavelengths of one sample.
// docs/rendering.md, "Surfaces".
#pragma once

#include <concepts>
#include <string_view>
#include <type_traits>

#include "render/bsdf/inputs.h"
#include "render/math/vec.h"
#include "render/spectral/sampled_spectrum.h"

namespace latent::render {

// A direction that a closure has drawn.
struct ClosureSample {
    Vec3f wi;
    bool delta = false;  // from a delta function: its two probabilities below are set, else f and pdf_omega say everything
    float probability = 0, probability_reverse = 0;
    float eta2 = 1;  // squared index on wi's side over that on wo's; 1 for reflection
};

// Directions are local: they point away from the surface, z is the shading normal. Values are those of radiance flowing from
// w_light to w_camera, whichever subpath came first. A closure is small and has no destructor; the values that it points to live
// as long as their sample. The side rule, light subpaths and the compression of radiance in delta refractions are Bsdf's.
//
//   kName           as MaterialDescription::type names it
//   kInputs         what it is made of (inputs.h); a constructor takes their Values
//   is_isotropic    of those: turning it about z changes nothing; else local x is along dp/du. Left out: always
//   kTransmits      what it scatters may leave on the other side; otherwise both directions of f and pdf_omega are on one side
//   is_delta        all directions come from delta functions; f and pdf_omega are not called
//   albedo          about the share of light that it scatters in each wavelength, whatever the directions: a feature for denoisers,
//                   which no radiance depends on
//   disperses       light from w_light to w_camera is refracted by an index that varies: only the kept wavelength is right
//   multiply_f_cos  value *= f |w_light.z|
//   pdf_omega       density [1/sr] with which `sample` finds wi
//   sample          draws wi for a wo with z != 0; false: absorbed. From a delta function also: weight *= coefficient over
//                   probability, as if radiance were not compressed
template <class C>
concept Closure = std::is_trivially_copyable_v<C> && std::is_trivially_destructible_v<C> &&
    requires(const C& c, const Values<C>& v, const Vec3f& w, float u, ClosureSample& out, SampledSpectrum& value) {
    { C::kName } -> std::convertible_to<std::string_view>;
    {C(v)};
    { C::kTransmits } -> std::convertible_to<bool>;
    { c.is_delta() } -> std::same_as<bool>;
    { c.albedo() } -> std::same_as<SampledSpectrum>;
    { c.disperses(w, w) } -> std::same_as<bool>;
    { c.multiply_f_cos(w, w, value) } -> std::same_as<void>;
    { c.pdf_omega(w, w) } -> std::same_as<float>;
    { c.sample(w, u, u, u, out, value) } -> std::same_as<bool>;
};

}  // namespace latent::render
