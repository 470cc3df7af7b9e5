// render/bsdf/sheen.h: fibres that stand up from a surface, as on velvet, above the metallic-roughness material: glTF's sheen.
// docs/rendering.md, "Surfaces".
#pragma once

#include "render/bsdf/closure.h"
#include "render/bsdf/metallic_roughness.h"

namespace latent::render {

//   f = c D G / (4 cos cos) + min(1 - c E(a), 1 - c E(b)) f_base
// in each wavelength: c the sheen's colour, D(h) = (2 + 1/alpha) sin(h)^(1/alpha) / (2 pi), G = 1 / (1 + Lambda(a) + Lambda(b))
// with the fit of [EstevezKulla17], E the albedo of D G / (4 cos cos), tabulated [glTF2 KHR_materials_sheen]. Reciprocal. The same
// from both sides.
class Sheen {
 public:
    static constexpr std::string_view kName = "sheen";
    static constexpr std::array kInputs = joined(
        MetallicRoughness::kInputs, std::array{Input::reflectance("sheen.color"), Input::number("sheen.roughness", 0, 0, 1)});
    static constexpr bool kTransmits = false;
    static constexpr float kMinAlpha = 0.01f;  // what is sharper is seen at grazing angles alone

    struct State {
        MetallicRoughness base;
        const SampledSpectrum* color;
        float alpha;  // the square of roughness
    };
    explicit Sheen(const Values<Sheen>& v);
    static bool is_isotropic(const Values<Sheen>& v) { return MetallicRoughness::is_isotropic(v); }
    explicit Sheen(const State& state);

    bool is_delta() const { return false; }
    bool is_coated() const { return state_.base.is_coated(); }
    Sheen with_coat_normal(const Vec3f& n) const {
        Sheen out = *this;
        out.state_.base = state_.base.with_coat_normal(n);
        return out;
    }
    SampledSpectrum albedo() const { return state_.base.albedo(); }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    State state_;
    float alpha_, sheen_probability_;  // that a direction is drawn for the sheen, by the cosine
};

}  // namespace latent::render
