#include "render/material/material.h"

namespace latent::render {

Material::Material(const MaterialDescription& d, SpectrumLibrary& library)
    : kind_(d.kind),
      dispersive_(d.dispersive),
      reflectance_(library.add(d.reflectance, Lookup::kLinear)),
      specular_(library.add(d.specular, Lookup::kLinear)),
      eta_(library.add(d.eta, Lookup::kLinear)),
      k_(library.add(d.k, Lookup::kLinear)),
      exponent_(d.exponent),
      alpha_x_(d.alpha_x),
      alpha_y_(d.alpha_y) {}

Bsdf Material::bsdf(const SurfaceHit& hit, SampledSpectra& spectra, std::uint32_t kept) const {
    const Frame frame = alpha_x_ == alpha_y_ ? Frame::from_z(hit.ns) : Frame::from_z_x(hit.ns, hit.dpdu);
    const auto bsdf_of = [&](const auto& closure) { return Bsdf(frame, hit.ng, closure); };
    switch (kind_) {
        case MaterialKind::kDiffuse:
            return bsdf_of(Diffuse(spectra[reflectance_]));
        case MaterialKind::kPhong:
            return bsdf_of(Phong(spectra[reflectance_], spectra[specular_], exponent_));
        case MaterialKind::kConductor:
            return bsdf_of(Conductor(spectra[eta_], spectra[k_], alpha_x_, alpha_y_));
        case MaterialKind::kDielectric:
            return bsdf_of(Dielectric(spectra[eta_], dispersive_, kept, alpha_x_, alpha_y_));
        case MaterialKind::kThinDielectric:
            return bsdf_of(ThinDielectric(spectra[eta_], dispersive_, kept));
    }
    __builtin_unreachable();
}

}  // namespace latent::render
