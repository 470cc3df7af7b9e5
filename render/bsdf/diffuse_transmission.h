// render/bsdf/diffuse_transmission.h: Lambert's reflection and transmission, f = R / pi on one side and T / pi through to the
// other. docs/rendering.md, "Surfaces".
#pragma once

#include <algorithm>

#include "render/bsdf/closure.h"

namespace latent::render {

class DiffuseTransmission {
 public:
    static constexpr std::string_view kName = "diffusetransmission";
    static constexpr std::array kInputs = {Input{.name = "reflectance", .factor = "scale"},
                                           Input{.name = "transmittance", .factor = "scale"}, Input::number("scale", 1, 0, 1e6f)};
    static constexpr bool kTransmits = true;

    explicit DiffuseTransmission(const Values<DiffuseTransmission>& v)
        : DiffuseTransmission(v.spectrum("reflectance"), v.spectrum("transmittance")) {}
    DiffuseTransmission(const SampledSpectrum& reflectance, const SampledSpectrum& transmittance);

    bool is_delta() const { return false; }
    SampledSpectrum albedo() const {
        return spectrum_of([&](std::uint32_t i) { return std::min((*reflectance_)[i] + (*transmittance_)[i], 1.0f); });
    }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    const SampledSpectrum* reflectance_;
    const SampledSpectrum* transmittance_;
    float reflection_probability_;
};

}  // namespace latent::render
