#include "render/bsdf/thin_dielectric.h"

#include "render/bsdf/fresnel.h"

namespace latent::render {
namespace {

// All bounces between the two faces: F + (1 - F)^2 F / (1 - F^2).
float of_pane(float f) { return 2 * f / (1 + f); }

}  // namespace

// Reflection with its probability, straight on else.
bool ThinDielectric::sample(const Vec3f& wo, float u_lobe, float, float, ClosureSample& out, SampledSpectrum& weight) const {
    const float c = std::abs(wo.z);
    const bool is_filmed = film_.share > 0, is_spectral = dispersive_ || is_filmed;
    SampledSpectrum reflectance;
    if (is_spectral) {
        const ThinFilm::Ray ray(film_, c);
        reflectance = spectrum_of([&](std::uint32_t i) {
            const float bare = fresnel_dielectric(c, (*eta_)[i]);
            if (!is_filmed) return of_pane(bare);
            return of_pane(bare + film_.share * (ray.reflectance((*eta_)[i], wavelengths_->lambda_nm[i]) - bare));
        });
    }
    const float r = is_filmed ? mean_of(reflectance, wavelengths_->k) : of_pane(fresnel_dielectric(c, eta_kept_));
    const bool reflected = u_lobe < r;
    out.wi = reflected ? Vec3f{-wo.x, -wo.y, wo.z} : -wo;
    out.delta = true;
    out.probability = out.probability_reverse = reflected ? r : 1 - r;
    if (!reflected && transmittance_ != nullptr) weight *= *transmittance_;
    if (!is_spectral) return true;
    if (reflected) {
        weight *= reflectance;
        weight *= 1 / r;
    } else {
        weight *= spectrum_of([&](std::uint32_t i) { return (1 - reflectance[i]) / (1 - r); });
    }
    return true;
}

}  // namespace latent::render
