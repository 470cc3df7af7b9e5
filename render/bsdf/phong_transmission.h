// render/bsdf/phong_transmission.h: Lambert's transmission, and Phong's lobe about the refracted direction. docs/scenes.md,
// "Extensions".
#pragma once

#include <algorithm>

#include "render/bsdf/closure.h"

namespace latent::render {

// To a camera behind the surface, `eta` the index there over that before it,
//   f = Kd / pi min(1, eta^2) + Ks (n + 2) / (2 pi) max(0, cos a)^n,
// a the angle, behind, between the one direction and the other one refracted [R06 9.6]; to a camera before it, f / eta^2, as
// radiance is compressed. The angle is that of both orders, so this is reciprocal. Kd + Ks <= 1 conserves energy: as in Phong's
// reflection, parts of the lobe are cut off; so is what total reflection would keep back.
class PhongTransmission {
 public:
    static constexpr std::string_view kName = "phongtransmission";
    static constexpr std::array kInputs = {Input::reflectance("Kd"), Input::reflectance("Ks"),
                                           Input::number("exponent", 0, 0, 1e6f), Input::number("eta", 1, 1e-3f, 1e3f)};
    static constexpr bool kTransmits = true;

    explicit PhongTransmission(const Values<PhongTransmission>& v)
        : PhongTransmission(v.spectrum("Kd"), v.spectrum("Ks"), v.number("exponent"), v.number("eta")) {}
    PhongTransmission(const SampledSpectrum& diffuse, const SampledSpectrum& specular, float exponent, float eta);

    bool is_delta() const { return false; }
    SampledSpectrum albedo() const {
        return spectrum_of([&](std::uint32_t i) { return std::min((*diffuse_)[i] + (*specular_)[i], 1.0f); });
    }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    struct Lobe {
        float power;    // (cos a)^n
        float stretch;  // d omega of the refracted direction, behind, over that of the one before the surface
    };
    Lobe lobe(const Vec3f& a, const Vec3f& b) const;

    const SampledSpectrum* diffuse_;
    const SampledSpectrum* specular_;
    float exponent_, eta_;
    float specular_probability_;  // that a direction is drawn from the lobe
};

}  // namespace latent::render
