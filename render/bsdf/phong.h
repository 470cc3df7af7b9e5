// render/bsdf/phong.h: Lambert's reflection and Phong's lobe, normalised to give back no more than it gets, on both sides.
// docs/rendering.md, "Surfaces".
#pragma once

#include <algorithm>

#include "render/bsdf/closure.h"

namespace latent::render {

//   f = Kd / pi + Ks (n + 2) / (2 pi) max(0, cos a)^n,   a the angle between w_light and the mirror direction of w_camera, or, if
//                                                       the surface is retro-reflecting, between w_light and w_camera [R06 9.6]
// [R06 3.1.2]. Kd + Ks <= 1 conserves energy; at grazing angles the surface cuts off a part of the lobe.
class Phong {
 public:
    static constexpr std::string_view kName = "phong";
    static constexpr std::array kInputs = {Input::reflectance("Kd"), Input::reflectance("Ks"),
                                           Input::number("exponent", 0, 0, 1e6f), Input::option("retro", 0)};
    static constexpr bool kTransmits = false;

    explicit Phong(const Values<Phong>& v)
        : Phong(v.spectrum("Kd"), v.spectrum("Ks"), v.number("exponent"), v.option("retro") != 0) {}
    Phong(const SampledSpectrum& diffuse, const SampledSpectrum& specular, float exponent, bool retro = false);

    bool is_delta() const { return false; }
    SampledSpectrum albedo() const {
        return spectrum_of([&](std::uint32_t i) { return std::min((*diffuse_)[i] + (*specular_)[i], 1.0f); });
    }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    const SampledSpectrum* diffuse_;
    const SampledSpectrum* specular_;
    float exponent_;
    bool retro_;
    float specular_probability_;  // that a direction is drawn from the lobe
};

}  // namespace latent::render
