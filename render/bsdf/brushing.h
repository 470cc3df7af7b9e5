// render/bsdf/brushing.h: facets that are rougher in one direction, as brushed metal's are [glTF2 KHR_materials_anisotropy].
// docs/rendering.md, "Surfaces".
#pragma once

#include <cmath>

#include "render/bsdf/inputs.h"
#include "render/math/elementary.h"

namespace latent::render {

struct Brushing {
    float strength = 0;
    Vec2f direction{1, 0};  // in which facets are rougher: unit, of local x and y

    // What closures that can have it are made of: the direction (2 x - 1, 2 y - 1), turned; x is that of dp/du, and y goes where v
    // goes.
    static constexpr std::array kInputs = {Input::directed("anisotropy", 0), Input::number("anisotropy_x", 1, 0, 1),
                                           Input::number("anisotropy_y", 0.5f, 0, 1), Input::number("anisotropy_turns", 0, -1, 1)};
    template <class C>
    static Brushing of(const Values<C>& v) {
        Brushing out{.strength = v.number("anisotropy")};
        if (out.strength == 0) return out;
        const SinCos r = sincos_turns(v.number("anisotropy_turns"));
        const float x = 2 * v.number("anisotropy_x") - 1, y = 2 * v.number("anisotropy_y") - 1;
        const Vec2f turned{r.cos * x - r.sin * y, r.sin * x + r.cos * y};
        const float size = std::sqrt(turned.x * turned.x + turned.y * turned.y);
        if (size > 0) out.direction = {turned.x / size, (v.site.mirrored ? -turned.y : turned.y) / size};
        return out;
    }
    template <class C>
    static bool is_there(const Values<C>& v) {
        return v.number("anisotropy") != 0;
    }

    // The alpha along the direction, for facets that have this alpha across it.
    float alpha_along(float alpha) const { return alpha + (1 - alpha) * strength * strength; }
    // Into the frame of the facets, and back.
    Vec3f to_facets(const Vec3f& w) const {
        return {w.x * direction.x + w.y * direction.y, w.y * direction.x - w.x * direction.y, w.z};
    }
    Vec3f from_facets(const Vec3f& w) const {
        return {w.x * direction.x - w.y * direction.y, w.x * direction.y + w.y * direction.x, w.z};
    }
};

}  // namespace latent::render
