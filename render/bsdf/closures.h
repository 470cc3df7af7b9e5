// render/bsdf/closures.h: the list of closures.
#pragma once

#include <algorithm>
#include <array>
#include <type_traits>
#include <variant>

#include "render/bsdf/closure.h"
#include "render/bsdf/coated.h"
#include "render/bsdf/conductor.h"
#include "render/bsdf/dielectric.h"
#include "render/bsdf/diffuse.h"
#include "render/bsdf/diffuse_transmission.h"
#include "render/bsdf/hair.h"
#include "render/bsdf/measured.h"
#include "render/bsdf/metallic_roughness.h"
#include "render/bsdf/phong.h"
#include "render/bsdf/phong_transmission.h"
#include "render/bsdf/sheen.h"
#include "render/bsdf/thin_dielectric.h"

namespace latent::render {

template <class... C>
using ClosureList = std::variant<C...>;

// Closures of surfaces: light arrives at and leaves one of two sides.
using SurfaceClosure = ClosureList<  //
    Diffuse,                         //
    Phong,                           //
    PhongTransmission,               //
    Conductor,                       //
    Dielectric,                      //
    ThinDielectric,                  //
    MetallicRoughness,               //
    Sheen,                           //
    DiffuseTransmission,             //
    CoatedDiffuse,                   //
    CoatedConductor,                 //
    Measured>;

template <class List, class... More>
struct Longer;
template <class... C, class... More>
struct Longer<ClosureList<C...>, More...> {
    using List = ClosureList<C..., More...>;
};
using AnyClosure = Longer<SurfaceClosure, Hair>::List;

template <class C>
constexpr bool is_sound() {
    static_assert(Closure<C>, "it lacks one of the members that closure.h lists");
    static_assert(are_sound(C::kInputs), "two of its inputs have one name, or a factor is no number among them");
    return true;
}
template <class... C>
constexpr bool are_sound(std::type_identity<ClosureList<C...>>) {
    constexpr std::array names = {C::kName...};
    return (... && is_sound<C>()) &&
           std::ranges::all_of(names, [&](const auto& name) { return std::ranges::count(names, name) == 1; });
}
static_assert(are_sound(std::type_identity<AnyClosure>()), "two closures have one name");

}  // namespace latent::render
