// render/bsdf/closures.h: the list of closures.
#pragma once

#include <variant>

#include "render/bsdf/closure.h"
#include "render/bsdf/coated.h"
#include "render/bsdf/conductor.h"
#include "render/bsdf/dielectric.h"
#include "render/bsdf/diffuse.h"
#include "render/bsdf/diffuse_transmission.h"
#include "render/bsdf/hair.h"
#include "render/bsdf/metallic_roughness.h"
#include "render/bsdf/phong.h"
#include "render/bsdf/phong_transmission.h"
#include "render/bsdf/sheen.h"
#include "render/bsdf/thin_dielectric.h"

namespace latent::render {

template <Closure... C>
using ClosureList = std::variant<C...>;

// Of surfaces, which light meets and leaves on sides.
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
    CoatedConductor>;

template <class List, class... More>
struct Longer;
template <class... C, class... More>
struct Longer<ClosureList<C...>, More...> {
    using List = ClosureList<C..., More...>;
};
using AnyClosure = Longer<SurfaceClosure, Hair>::List;

}  // namespace latent::render
