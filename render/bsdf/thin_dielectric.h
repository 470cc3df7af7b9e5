// render/bsdf/thin_dielectric.h: a smooth pane of clear matter, with all reflections between its faces. docs/rendering.md,
// "Surfaces".
#pragma once

#include "render/bsdf/closure.h"

namespace latent::render {

class ThinDielectric {
 public:
    static constexpr std::string_view kName = "thindielectric";
    static constexpr std::array kInputs = {Input::index("eta"), Input{.name = "transmittance", .may_be_missing = true}};
    static constexpr bool kTransmits = true;

    explicit ThinDielectric(const Values<ThinDielectric>& v)
        : ThinDielectric(v.spectrum("eta"), v.varies("eta"), v.site.kept, v.find("transmittance")) {}
    // `eta` in each wavelength. Nothing is refracted: all wavelengths go on together, with the probabilities of the `kept` one.
    // What goes straight on is multiplied by `transmittance`, if there is one.
    ThinDielectric(const SampledSpectrum& eta, bool dispersive, std::uint32_t kept, const SampledSpectrum* transmittance = nullptr)
        : eta_(&eta), transmittance_(transmittance), eta_kept_(eta[kept]), dispersive_(dispersive) {}

    bool is_delta() const { return true; }
    SampledSpectrum albedo() const { return transmittance_ ? *transmittance_ : SampledSpectrum(1.0f); }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f&, const Vec3f&, SampledSpectrum& value) const { value = SampledSpectrum(0.0f); }
    float pdf_omega(const Vec3f&, const Vec3f&) const { return 0; }
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    const SampledSpectrum *eta_, *transmittance_;
    float eta_kept_;
    bool dispersive_;
};

}  // namespace latent::render
