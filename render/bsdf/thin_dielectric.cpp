#include "render/bsdf/thin_dielectric.h"

#include "render/bsdf/fresnel.h"

namespace latent::render {
namespace {

// All bounces between the two faces: F + (1 - F)^2 F / (1 - F^2).
float pane_reflectance(float c, float eta) {
    const float f = fresnel_dielectric(c, eta);
    return 2 * f / (1 + f);
}

}  // namespace

// Reflection with its probability at the kept wavelength, straight on else.
bool ThinDielectric::sample(const Vec3f& wo, float u_lobe, float, float, ClosureSample& out, SampledSpectrum& weight) const {
    const float c = std::abs(wo.z), r = pane_reflectance(c, eta_kept_);
    const bool reflected = u_lobe < r;
    out.wi = reflected ? Vec3f{-wo.x, -wo.y, wo.z} : -wo;
    out.delta = true;
    out.probability = out.probability_reverse = reflected ? r : 1 - r;
    if (!reflected && transmittance_ != nullptr) weight *= *transmittance_;
    if (!dispersive_) return true;
    const SampledSpectrum reflectance = spectrum_of([&](std::uint32_t i) { return pane_reflectance(c, (*eta_)[i]); });
    if (reflected) {
        weight *= reflectance;
        weight *= 1 / r;
    } else {
        weight *= spectrum_of([&](std::uint32_t i) { return (1 - reflectance[i]) / (1 - r); });
    }
    return true;
}

}  // namespace latent::render
