// render/bsdf/diffuse.h: Lambert's reflection, f = R / pi, on both sides. docs/rendering.md, "Surfaces".
#pragma once

#include "render/bsdf/closure.h"

namespace latent::render {

class Diffuse {
 public:
    static constexpr std::string_view kName = "diffuse";
    static constexpr std::array kInputs = {Input::reflectance("reflectance")};
    static constexpr bool kTransmits = false;

    explicit Diffuse(const Values<Diffuse>& v) : Diffuse(v.spectrum("reflectance")) {}
    explicit Diffuse(const SampledSpectrum& reflectance) : reflectance_(&reflectance) {}

    const SampledSpectrum& reflectance() const { return *reflectance_; }
    bool is_delta() const { return false; }
    SampledSpectrum albedo() const { return *reflectance_; }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    const SampledSpectrum* reflectance_;
};

}  // namespace latent::render
